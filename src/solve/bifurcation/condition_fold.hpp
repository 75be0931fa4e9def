#pragma once
// The condition of a fold, for those that extend it.

#include "whirl/solve/bifurcation/condition.hpp"

namespace whirl::solve {

class FoldCondition : public Condition {
public:
  FoldCondition(ExtendedProblem& problem, Adjoint& adjoint);
  Eigen::VectorXd values(Vec u, const Eigen::VectorXd& inner) override;
  void derivatives(Vec u, const Eigen::VectorXd& inner, Eigen::MatrixXd& d_inner,
                   std::vector<core::Vector>& gradients) override;
  void update() override {}
  std::vector<CodimensionTest> tests(Vec u, const Eigen::VectorXd& inner, Vec along) override;

private:
  ExtendedProblem& problem_;
  Adjoint& adjoint_;
  core::Vector z_, unit_;
  double quadratic_ = 0;  // change of the parameter's share in the tangent per arclength
};

}  // namespace whirl::solve
