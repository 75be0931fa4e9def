#pragma once
// LU of a sparse pencil, on one rank or several.

#include <Eigen/SparseCore>
#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "whirl/core/band_lu.hpp"
#include "whirl/core/entry_stream.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/core/pivoted_lu.hpp"

namespace whirl::core {

/// Where an entry stands, by numbers in the whole matrix.
struct PencilPlace {
  PetscInt row, column;
};

/// A = alpha a + sigma b, whose rows stand on the ranks of a communicator in their order. On one rank the factors are
/// BandLu's of a real matrix whose band pays, else PivotedLu's, without such a band up to a size. Else they are
/// MUMPS's, for complex numbers in real form, p + i q as the block [p -q; q p]. Scalar: double or std::complex<double>.
/// Collective on the communicator.
template <class Scalar>
class PencilLu {
public:
  using Place = PencilPlace;
  /// This rank has `rows` rows with entries of a and b at these places; entries of one place add up. MUMPS reads PETSc
  /// options with `prefix` if there is one.
  PencilLu(MPI_Comm comm, PetscInt rows, std::vector<Place> a, std::vector<Place> b, const char* prefix = nullptr);
  /// Factorises, with the entries of a and b in the order of their places. On one rank the factors are kept if all
  /// values are the same, to rounding (1e-12 of each).
  void set(std::span<const double> a, std::span<const double> b, double alpha, Scalar sigma);
  /// x = A^-1 r, or A^-* r (conjugate transpose), of this rank's [rows x columns]. Not finite if A is singular.
  void solve(bool adjoint, std::span<const Scalar> r, std::span<Scalar> x);

private:
  static constexpr PetscInt width = sizeof(Scalar) / sizeof(double);
  using Columns = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  void add(Place p, double value) { stream_.add(p.row, p.column, value); }
  void add(Place p, std::complex<double> value);
  void solve_spread(bool adjoint, std::span<const Scalar> r, std::span<Scalar> x);

  MPI_Comm comm_;
  PetscInt rows_;
  bool alone_, regular_ = false;
  std::vector<Place> a_, b_;
  Eigen::SparseMatrix<Scalar> matrix_;     // on one rank
  std::vector<Eigen::Index> in_a_, in_b_;  // where entries stand in its values
  std::optional<BandLu> band_;             // or
  PivotedLu<Scalar> lu_;
  Matrix spread_;  // on several
  EntryStream stream_;
  LinearSolver solver_;
};

extern template class PencilLu<double>;
extern template class PencilLu<std::complex<double>>;

}  // namespace whirl::core
