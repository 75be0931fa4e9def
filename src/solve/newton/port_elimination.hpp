#pragma once
// Block elimination of the parts of a machine on their ports.

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "whirl/core/petsc.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::solve {

/// Solves matrices whose parts (films, solids) see a hub (machine and border), but not each other:
///
///     [ A_pp  G   ] [ x_p ]   [ b_p ]     X = A_pp^-1 G
///     [ F     A_h ] [ x_h ] = [ b_h ]     (A_h - F X) x_h = b_h - F A_pp^-1 b_p,   x_p = A_pp^-1 b_p - X x_h
///
/// A part sees few unknowns of the hub, its ports, and the border column: G has few columns. F is held as F^T, spread
/// like the parts, so that products with it are local; the assembled matrix has the rows of F on the hub's rank.
/// Columns of G that no part sees both of share one right-hand side. A_pp is solved by a KSP with prefix "parts_"
/// (MUMPS, all parts at once), what is left on the hub by one with prefix "hub_" (MUMPS). A_pp has to be regular: films
/// at given motions are. factorise() and the solves throw core::NotConverged, on all ranks, if a matrix is singular.
/// All members are collective on the communicator of the matrix.
class PortElimination {
public:
  /// Whether there are parts, and no more of them than this keeps apart (63).
  [[nodiscard]] static bool serves(const std::vector<problem::Field>& fields) {
    const std::size_t parts = problem::parts_of(fields).size();
    return parts > 1 && parts <= 64;
  }
  /// `fields`: the hub first, in local rows of the matrices to come; local rows in none of them belong to the hub.
  PortElimination(MPI_Comm comm, const std::vector<problem::Field>& fields);

  /// `a` has the same pattern in every call.
  void factorise(Mat a);
  void solve(Vec rhs, Vec x);
  void solve_transposed(Vec rhs, Vec x);

private:
  void make_layout(Mat a);
  void find_ports();
  void solve_columns();
  void form_hub();
  /// The part of a local row of the parts.
  [[nodiscard]] std::size_t part_of(PetscInt row) const;
  /// Between a vector and its entries of parts and hub: into part_rhs_, hub_rhs_; from part_answer_, hub_answer_.
  void take(Vec whole);
  void give(Vec whole);
  /// Entries of hub_answer_, on every rank.
  [[nodiscard]] Eigen::VectorXd hub_values(const std::vector<PetscInt>& rows) const;
  /// hub_rhs_ -= the sum over the ranks of their shares.
  void take_from_hub(const std::vector<PetscInt>& rows, Eigen::VectorXd shares) const;
  template <class F>
  void for_ports(F&& f) const;

  MPI_Comm comm_;
  std::vector<problem::Field> fields_;
  core::IndexSet hub_rows_, part_rows_;
  core::Matrix parts_, to_parts_, to_hub_, hub_, schur_;  // A_pp, G, F, A_h, A_h - F X
  core::Vector part_rhs_, part_answer_, hub_rhs_, hub_answer_;
  core::Scatter part_scatter_, hub_scatter_;
  core::LinearSolver part_solver_, hub_solver_;
  std::vector<PetscInt> ports_, coupled_;  // hub unknowns that parts see; hub rows that see parts: numbers in the hub
  std::vector<int> colour_;                // of each port
  std::vector<std::vector<int>> port_of_;  // [part][colour]: place among the ports, -1 for none
  std::map<PetscInt, int> colour_of_;      // of a hub unknown
  int colours_ = 0;
  core::Matrix columns_, answers_;   // right-hand sides by colour, and X
  std::vector<PetscInt> part_ends_;  // local rows of the parts, part by part
  Eigen::MatrixXd x_;                // X in colours [local x colours]
  Eigen::MatrixXd from_parts_;       // F^T [local x coupled]
};

}  // namespace whirl::solve
