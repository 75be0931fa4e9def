#pragma once
// Implicit Runge-Kutta at Gauss points.

#include "transient/steps/equations.hpp"
#include "transient/steps/stepper.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::transient {

/// F(t + c_i h, Y_i, K_i) = 0 with h K = A^-1 (Y - u_0), u_1 = u_0 + h sum b_i K_i: order twice the stages; conserves
/// quadratic invariants, and damps nothing however stiff.
///
/// A simplified Newton's method with the Jacobian of the step's beginning and, in place of A, its lower factor L of A =
/// L U with ones on the diagonal of U (van der Houwen and de Swart 1997): stages are solved one after the other, each
/// with a matrix of the size of the system. PETSc's TSIRK takes no F that is not solved for the rates.
class GaussSteps final : public Stepper {
public:
  /// `tolerance` of Newton's method, on the scaled states.
  GaussSteps(Equations& equations, int stages, double tolerance);

  [[nodiscard]] Taken step(double time, double wanted, Vec u) override;
  [[nodiscard]] Pace pace() const override { return Pace::to_samples; }
  void forget() override;
  void pass_break() override {}

private:
  [[nodiscard]] bool attempt(double time, double length);

  Equations& equations_;
  solve::Tableau tableau_;
  double tolerance_;
  Eigen::MatrixXd inverse_, lower_;  // of A and of L
  Eigen::VectorXd end_weights_;      // of Y_i - u_0 in u_1 - u_0
  std::vector<std::unique_ptr<solve::Stage>> stages_;
  Eigen::VectorXd start_, value_, slope_, f_;
  Eigen::MatrixXd values_, changes_, residuals_, moved_;  // of the stages [n x stages]; E^-1 of one
};

}  // namespace whirl::transient
