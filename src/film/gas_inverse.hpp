#pragma once
// Approximate inverse of the equations of a film of gas.

#include <mpi.h>

#include <Eigen/LU>
#include <memory>
#include <span>
#include <vector>

#include "film/ring_preconditioner.hpp"
#include "whirl/film/film.hpp"

namespace whirl::film {

/// With nodes n, which stand in lines around a ring and are solved by a V-cycle M^-1, and the pressures o behind the
/// orifices:
///
///     Z = M^-1 A_no,   S = A_oo - A_on Z,   x_o = S^-1 (r_o - A_on M^-1 r_n),   x_n = M^-1 r_n - Z x_o
///
/// To eliminate the o first would be cheaper, but where a mesh resolves the orifices their share of a node's diagonal
/// may have any sign, and the V-cycle suffers.
class GasInverse final : public StatePreconditioner {
public:
  /// `share` as of GasFilm: a Stencil, then the entries of orifices; orifice k feeds node nodes[k] of the film, and its
  /// pressure is a state of the last rank. Every rank of `comm` holds two lines or more.
  GasInverse(MPI_Comm comm, int lines, int line, const Share& share, std::vector<int> nodes);
  void set(std::span<const double> d_states, std::span<const double> d_rates, double alpha, double sigma) override;
  void apply(std::span<const double> r, std::span<double> x) override;

private:
  void sum_over_ranks(Eigen::Ref<Eigen::MatrixXd> values) const;
  // Of nodes here, at the nodes of all orifices.
  [[nodiscard]] Eigen::VectorXd at_orifices(const double* x) const;
  // Row of the node of orifice k, or -1: another rank's.
  [[nodiscard]] int node(std::size_t k) const {
    const int row = nodes_[k] - begin_;
    return row >= 0 && row < held_ ? row : -1;
  }

  MPI_Comm comm_;
  int begin_, held_;  // first node here and their number
  bool owns_, alone_;
  std::vector<int> nodes_;
  RingPreconditioner ring_;
  double alpha_ = 1.0;
  Eigen::VectorXd to_node_, to_orifice_;  // A_no, A_on of every orifice
  Eigen::MatrixXd fed_;                   // Z [nodes here x orifices]
  Eigen::PartialPivLU<Eigen::MatrixXd> small_;
};

}  // namespace whirl::film
