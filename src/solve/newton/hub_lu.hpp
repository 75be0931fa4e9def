#pragma once
// LU of the linear part of a machine, with its answers to the forces of films.

#include <Eigen/Core>

#include "whirl/core/pivoted_lu.hpp"
#include "whirl/problem/structure.hpp"

namespace whirl::solve {

/// M^-1 of a sparse matrix M [n x n], and its answers to the forces B [n x r] as the inputs C [w x n] see them. A small
/// M has a dense inverse: one product without a dependence of one row on the next. Its answers want refinement, or
/// serve in Newton's method only.
class HubLu {
public:
  /// False if M is singular; nothing can be solved then.
  [[nodiscard]] bool factorise(const problem::SparseBlock& m, const problem::SparseBlock& b,
                               const problem::SparseBlock& c);
  void solve(const Eigen::VectorXd& y, Eigen::Ref<Eigen::VectorXd> x) const;
  void solve_transposed(const Eigen::VectorXd& y, Eigen::Ref<Eigen::VectorXd> x) const;
  /// M^-1 B [n x r] and C M^-1 B [w x r].
  [[nodiscard]] const Eigen::MatrixXd& lead() const { return lead_; }
  [[nodiscard]] const Eigen::MatrixXd& seen() const { return seen_; }

private:
  Eigen::MatrixXd inverse_;
  core::PivotedLu<double> sparse_;  // where that is too large
  Eigen::MatrixXd lead_, seen_;
};

}  // namespace whirl::solve
