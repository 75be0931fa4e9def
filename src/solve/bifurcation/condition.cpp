#include "whirl/solve/bifurcation/condition.hpp"

#include "solve/bifurcation/condition_fold.hpp"

namespace whirl::solve {

using core::check;

FoldCondition::FoldCondition(ExtendedProblem& problem, Adjoint& adjoint) : problem_(problem), adjoint_(adjoint) {}

Eigen::VectorXd FoldCondition::values(Vec u, const Eigen::VectorXd&) {
  PetscInt size = 0, known = -1;
  check(VecGetSize(u, &size));
  if (z_) check(VecGetSize(z_.get(), &known));
  if (size != known) {  // the first time, and on another mesh
    z_ = core::duplicate(u);
    unit_ = core::duplicate(u);
    parameter_row(problem_, unit_.get());
  }
  // The added row stands where the parameter does: one vector is the right-hand side of the forward and of the
  // transposed system.
  solve_linear(problem_, unit_.get(), z_.get(), "tangent_");
  return Eigen::VectorXd::Constant(1, last_entry(problem_.comm(), z_.get()));
}

void FoldCondition::derivatives(Vec u, const Eigen::VectorXd&, Eigen::MatrixXd& d_inner,
                                std::vector<core::Vector>& gradients) {
  d_inner.resize(1, 0);
  core::Vector w = core::duplicate(u);
  adjoint_.solve_transposed(unit_.get(), w.get());
  gradients.clear();
  gradients.push_back(core::duplicate(u));
  adjoint_.curvature(u, z_.get(), w.get(), gradients.front().get());
  check(VecScale(gradients.front().get(), -1));
  quadratic_ = dot(gradients.front().get(), z_.get());
}

std::vector<CodimensionTest> FoldCondition::tests(Vec, const Eigen::VectorXd&, Vec) {
  return {{"cusp", quadratic_}};
}

std::unique_ptr<Condition> make_fold(ExtendedProblem& problem, Adjoint& adjoint) {
  return std::make_unique<FoldCondition>(problem, adjoint);
}

}  // namespace whirl::solve
