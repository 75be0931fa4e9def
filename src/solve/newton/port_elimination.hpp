#pragma once
// Block elimination of the parts of a machine on their ports.

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "solve/newton/part_factors.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::solve {

/// Solves matrices whose parts (films, solids) see a hub (machine and border), but not each other:
///
///     [ A_pp  G   ] [ x_p ]   [ b_p ]     X = A_pp^-1 G
///     [ F     A_h ] [ x_h ] = [ b_h ]     (A_h - F X) x_h = b_h - F A_pp^-1 b_p,   x_p = A_pp^-1 b_p - X x_h
///
/// A_pp^-1 are the parts' own inverses, or PartFactors. What is left on the hub is solved by a KSP with prefix "hub_":
/// by KLU on the rank that holds most of it, to which the others lend their rows, such as a border's, and by MUMPS
/// where it is spread or large. With approximate inverses all of it is a preconditioner. A_pp has to be regular: films
/// at given motions are. Without parts all is hub. factorise() and the solves throw core::NotConverged, on all ranks,
/// if a matrix is singular. All members are collective on the communicator of the matrix.
class PortElimination {
public:
  /// `fields`: the hub first, in local rows of the matrices to come; local rows in none of them belong to the hub.
  /// `inverse` of the parts may be null.
  explicit PortElimination(std::vector<problem::Field> fields, std::unique_ptr<problem::PartInverse> inverse = nullptr);

  /// `a` has the same pattern in every call.
  void factorise(Mat a);
  /// The same of a matrix that is in its blocks already.
  void factorise(const PortMatrix& blocks);
  /// Of the parts alone, for solve_held().
  void factorise_parts(const PortMatrix& blocks);
  /// Whether one rank solves the hub, after the first factorise().
  [[nodiscard]] bool hub_alone() const { return hub_alone_; }
  /// The blocks of the matrix of factorise(a).
  [[nodiscard]] const PortMatrix& blocks() const { return *blocks_; }
  /// The parts' own inverses, for the caller to set() before factorise(); null where there are none.
  [[nodiscard]] problem::PartInverse* inverse() const { return inverse_.get(); }
  void solve(Vec rhs, Vec x);
  /// The same with the hub held: A_pp^-1 b_p, or what approximates it, and zeros.
  void solve_held(Vec rhs, Vec x);
  /// Of matrices whose parts are solved exactly.
  void solve_transposed(Vec rhs, Vec x);

private:
  void make_solvers();
  void form_hub(const PortMatrix& blocks);
  void take(Vec whole);
  void give(Vec whole) const;
  /// A_pp^-1 of columns, or its transpose.
  [[nodiscard]] Eigen::MatrixXd solve_parts(const Eigen::MatrixXd& right, bool transposed);
  void solve_hub(bool transposed);
  /// Makes room for what this rank takes from so many rows of the hub.
  void clear_shares(std::size_t rows);
  /// hub_rhs_ = own_hub_ of all ranks that it belongs to, less shares_, summed over the ranks, in these rows.
  void take_from_hub(const std::vector<PetscInt>& rows);
  /// Where a row of the hub stands among those that are lent to the leader.
  [[nodiscard]] PetscInt lent(PetscInt row) const;
  [[nodiscard]] bool leads() const { return core::rank_of(layout_->comm()) == leader_; }
  /// Rows of the hub that this rank solves for, and the first of them.
  [[nodiscard]] PetscInt solved_hub() const;
  [[nodiscard]] PetscInt first_solved() const { return hub_alone_ ? 0 : layout_->first_of_hub(); }

  std::vector<problem::Field> fields_;
  std::unique_ptr<problem::PartInverse> inverse_;
  std::shared_ptr<const PortLayout> layout_;
  std::unique_ptr<PortMatrix> blocks_;  // of factorise(a)
  bool any_ = false;                    // there are parts
  bool hub_alone_ = false;              // the hub is solved by one rank, which holds most of it,
  bool hub_once_ = false;               // by its factors alone: a KSP would look for its options in every solve
  int leader_ = 0;                      // this rank
  PetscInt lent_ = 0;                   // rows of the hub on other ranks
  std::unique_ptr<PartFactors<double>> factors_;  // where there is no inverse
  core::Matrix schur_;                            // A_h - F X
  core::Vector hub_rhs_, hub_answer_;
  core::LinearSolver hub_solver_;
  Eigen::MatrixXd x_, of_parts_;                       // X [parts x colours]; x_p [parts x 1]
  std::shared_ptr<const Eigen::MatrixXd> from_parts_;  // F^T of the blocks
  Eigen::VectorXd shares_, own_hub_, all_hub_;         // work space: of one rank; its rows of the hub; the hub's answer
};

}  // namespace whirl::solve
