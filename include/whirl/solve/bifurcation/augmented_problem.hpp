#pragma once
// A bifurcation as a solution: the minimally augmented system.

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "whirl/solve/bifurcation/condition.hpp"

namespace whirl::solve {

/// A second parameter of the equations behind a branch problem.
struct SecondParameter {
  /// Takes the value (SI) and rebuilds what depends on it; the first parameter stays. Throws core::DomainError, agreed
  /// on all ranks.
  std::function<void(double)> set;
  double scale = 1;  ///< SI value of one unit of the scaled parameter
};

/// R(u, q) = 0, g(u, z, q) = 0 in U = (u, z, q): a bifurcation and, with a second parameter q, the curve of them.
///
/// z are the inner unknowns of the condition; u keeps its layout and z, q stand behind it on the last rank. With K =
/// [dR/du; row] of the branch problem, regular at every bifurcation of codimension one, the whole system
///
///     [ R_u  .    R_q ]                u = K^-1 [r; 0] + alpha K^-1 e_last - dq K^-1 [R_q; 0]
///     [ g_u  g_z  g_q ]
///     [      added    ]                leaves a small dense system in (alpha, dz, dq)
///
/// costs two solves with K for the border and one per right-hand side. Derivatives in q are central differences of R
/// and g at constant u. Without a second parameter q has no part in R and g: newton() with the row of q locates one
/// point. Source: Govaerts (2000), ch. 4, 5.
class AugmentedProblem : public ExtendedProblem {
public:
  /// `branch` and `condition` outlive this. `along` [layout of u] is a tangent of the branch near the bifurcation, q_0
  /// the scaled second parameter, to which the branch problem is set.
  AugmentedProblem(ExtendedProblem& branch, Condition& condition, Vec along,
                   std::optional<SecondParameter> second = std::nullopt);

  [[nodiscard]] MPI_Comm comm() const override { return branch_.comm(); }
  [[nodiscard]] core::Vector make_unknown() const override;
  [[nodiscard]] Vec weights() const override { return weights_.get(); }
  [[nodiscard]] double parameter_scale() const override { return second_ ? second_->scale : 1; }
  void residual(Vec u, Vec r) override;
  void linearise(Vec u, Vec row) override;
  void multiply(Vec v, Vec y) override;
  void solve(Vec rhs, Vec x) override;
  bool adapt(core::Vector& u, core::Vector& tangent) override;

  /// Between U and its parts; `inner` and the scaled q are the same on every rank.
  void split(Vec whole, Vec u, Eigen::VectorXd& inner, double& q) const;
  void join(Vec u, const Eigen::VectorXd& inner, double q, Vec whole) const;
  [[nodiscard]] core::Vector branch_part(Vec whole) const;
  /// Scaled first parameter / inner unknowns at U.
  [[nodiscard]] double first_parameter(Vec whole) const;
  [[nodiscard]] Eigen::VectorXd inner(Vec whole) const;

  /// Borders for the first Newton solve: the null vectors near the guess U, by inverse iteration. Throws
  /// core::DomainError.
  void prime(Vec whole);
  /// Refreshes the borders at the U linearised last: to be called between Newton solves, at each accepted point.
  void update();
  /// Tests of the condition at the U linearised last.
  [[nodiscard]] std::vector<CodimensionTest> tests();
  /// Gradients of g in u, and the tangent of the branch at constant q, where U was linearised last.
  [[nodiscard]] const std::vector<core::Vector>& gradients() const { return gradients_; }
  [[nodiscard]] Vec tangent() const { return tangent_.get(); }

private:
  /// Takes the branch problem's present layout; `along` is a tangent of the branch there.
  void lay_out(Vec along);
  void set_second(double q);
  void evaluate(Vec whole);

  ExtendedProblem& branch_;
  Condition& condition_;
  std::optional<SecondParameter> second_;
  Eigen::Index inner_size_;
  core::Vector weights_, row_, unit_;
  // At the point evaluated last:
  core::Vector at_, u_;
  Eigen::VectorXd inner_, g_;
  double q_ = 0, set_q_ = 0;
  bool q_set_ = false;
  // The linearisation:
  std::vector<core::Vector> gradients_;
  core::Vector by_q_, tangent_, response_;  // R_q, K^-1 e_last, -K^-1 [R_q; 0]
  core::Vector added_;                      // the added row
  Eigen::MatrixXd g_inner_;
  Eigen::VectorXd g_q_;
  Eigen::MatrixXd small_;
};

/// The bifurcation of `branch` near u by Newton's method on the minimally augmented system of `condition`; `along` is a
/// tangent of the branch there. Nothing if that does not converge; `error` is the size of the last Newton step in the
/// parameter, which quadratic convergence has left far behind. The branch problem may be left linearised anywhere.
/// `inner` (may be null) takes the inner unknowns. Collective.
[[nodiscard]] std::optional<Refined> locate(ExtendedProblem& branch, Condition& condition, Vec u, Vec along,
                                            const NewtonOptions& options, Eigen::VectorXd* inner = nullptr);

/// The same for an event met on a branch, for BranchCallbacks::refine; nothing for events without a condition. With a
/// replay log what was found of an event of cycles is kept.
[[nodiscard]] std::optional<Refined> refine(PeriodicProblem& problem, const LocatedEvent& event, Vec u, Vec tangent,
                                            const NewtonOptions& options);
[[nodiscard]] std::optional<Refined> refine(problem::System& system, EquilibriumProblem& problem,
                                            const LocatedEvent& event, Vec u, Vec tangent,
                                            const NewtonOptions& options);

/// The condition that holds at an event of equilibria with the given critical eigenvalue [1/s]; null for branch points.
/// Cycles make theirs by PeriodicProblem::condition().
[[nodiscard]] std::unique_ptr<Condition> condition_of(problem::System& system, EquilibriumProblem& problem, Event event,
                                                      std::complex<double> critical);

/// A tangent of the branch at u, of unit length, whose sign is arbitrary but the same on any number of ranks: the null
/// vector of dR/du, by a generic last row. Throws core::NotConverged at a branch point. Collective.
[[nodiscard]] core::Vector any_tangent(ExtendedProblem& branch, Vec u);

}  // namespace whirl::solve
