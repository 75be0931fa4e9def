#pragma once
// The parts of a machine by LU, one after the other.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solve/newton/port_matrix.hpp"
#include "whirl/core/pencil_lu.hpp"

namespace whirl::solve {

/// A_i^-1 of all parts, A_i = a + sigma b of their own equations (core::PencilLu, prefix "parts_"). A part that stands
/// on one rank is solved there, others by all ranks. Scalar: double or std::complex<double>. Collective.
template <class Scalar>
class PartFactors {
public:
  using Columns = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  explicit PartFactors(std::shared_ptr<const PortLayout> layout);
  /// Of a, or with `b` of a + sigma b. Complex factors of parts of more than -parts_kept_states are made in solve(),
  /// until when a and b keep their values, and kept of one of them at a time; all others are made here.
  void set(const PortMatrix& a, const PortMatrix* b = nullptr, Scalar sigma = 0);
  /// A_i^-1 of each part's rows of the columns, or A_i^-* (conjugate transpose): this rank's rows [parts x columns].
  /// Not finite where A_i is singular.
  [[nodiscard]] Columns solve(const Columns& right, bool adjoint);

private:
  using Lu = core::PencilLu<Scalar>;
  struct Part {
    PortLayout::PartRows rows;
    bool large = false, made = false;
    std::vector<std::size_t> values;  // of its entries in the blocks
    std::unique_ptr<Lu> lu;           // null on ranks without a share of it
  };
  void factorise(std::size_t p);

  std::shared_ptr<const PortLayout> layout_;
  std::vector<Part> parts_;
  const PortMatrix *a_ = nullptr, *b_ = nullptr;
  Scalar sigma_{};
};

/// The parts' own inverses; null where the system has none, or where factors are asked for (core::plan::parts()).
[[nodiscard]] std::unique_ptr<problem::PartInverse> own_inverse(problem::System& system);

extern template class PartFactors<double>;
extern template class PartFactors<std::complex<double>>;

}  // namespace whirl::solve
