#pragma once
// Approximate inverse of the equations of a film of gas.

#include <mpi.h>

#include <memory>
#include <span>
#include <vector>

#include "film/algebra/ring_preconditioner.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film {

/// With nodes n, which stand in lines around a ring and are solved by a V-cycle M^-1, and the unknowns o of orifices:
///
///     Z = M^-1 A_no,   S = A_oo - A_on Z,   x_o = S^-1 (r_o - A_on M^-1 r_n),   x_n = M^-1 r_n - Z x_o
///
/// To eliminate the o first would be cheaper, but where a mesh resolves the orifices their share of a node's diagonal
/// may have any sign, and the V-cycle suffers.
class GasInverse final : public StateInverse {
public:
  /// `share` as of GasFilm: a Stencil, then the entries of orifices, which depend on `nodes` of the film and whose
  /// `unknowns` are states of the last rank. Every rank of `comm` holds two lines or more.
  GasInverse(MPI_Comm comm, int lines, int line, const Share& share, std::vector<int> nodes, int unknowns);
  void set(const StateDerivatives& at, double alpha, double sigma) override;
  void apply(std::span<const double> r, std::span<double> x) override;

private:
  void apply_to_one(std::span<const double> r, std::span<double> x);
  void sum_over_ranks(Eigen::Ref<Eigen::MatrixXd> values) const;
  // Of nodes here, at all nodes on which orifices depend.
  [[nodiscard]] Eigen::VectorXd read(const double* x) const;

  // An entry beside the stencil: where its value is, and its row and column among nodes here, among those that orifices
  // read, or among unknowns.
  struct Entry {
    std::size_t value;
    Eigen::Index row, column;
  };
  MPI_Comm comm_;
  int begin_, held_;  // first node here and their number
  bool owns_, alone_;
  std::vector<int> nodes_;  // that orifices read, each once
  std::vector<Entry> to_node_, to_orifice_, between_, by_rate_;
  RingPreconditioner ring_;
  Eigen::MatrixXd reads_;  // A_on [unknowns x nodes_]
  Eigen::MatrixXd fed_;    // Z [nodes here x unknowns]
  core::DenseLu<double> small_;
};

}  // namespace whirl::film
