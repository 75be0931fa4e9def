#pragma once
// The derivative of one diagonally implicit Runge-Kutta step.

#include "transient/steps/sdirk_steps.hpp"
#include "whirl/transient/steps/tangents.hpp"

namespace whirl::transient {

/// Weights of order one less than that of a scheme of order 4 with five stages, without the last stage: sum b = 1,
/// sum b c = 1/2, sum b c^2 = 1/3, sum b a c = 1/6. They estimate the error of a step.
[[nodiscard]] Eigen::VectorXd embedded_weights(const solve::Tableau& tableau);

/// b_i(theta) = sum_p w_ip theta^(p+1) [stages x 4]: u(t + theta h) = u_0 + h sum b_i(theta) K_i to order 3 within a
/// step, to order 4 at its end, by sum b = theta, sum b c = theta^2/2, sum b c^2 = theta^3/3, sum b a c = theta^3/6 and
/// sum b c^3 = theta^4/4.
[[nodiscard]] Eigen::MatrixXd continuous_weights(const solve::Tableau& tableau);

/// With stages Y_i = Z_i + h a_ii K_i, Z_i = u_0 + h sum_{j<i} a_ij K_j and F(t_i, Y_i, K_i) = 0, a deviation obeys
///
///     (dF/d(du/dt) + h a_ii dF/du) dK_i = -dF/du dZ_i,    du_1 = dZ_s + h a_ss dK_s  (stiffly accurate)
///
/// at the stages of the accepted step: the exact derivative of what was computed. Collective.
class StageTangents {
public:
  StageTangents(Equations& equations, const solve::Tableau& tableau);
  /// Carries all deviations over the last step of `steps`, of `length` from `time` on, for accept() to take over;
  /// returns the largest estimated error of any of them, relative to its length.
  double propagate(double time, double length, const SdirkSteps& steps, const Tangents& tangents);
  void accept(Tangents& tangents);
  void forget() { stage_ = equations_.make_stage(); }
  /// Where dF/d(du/dt) is singular a deviation must obey the equations without rates: one step of Euler's implicit
  /// scheme from `u` at `time`, so short that nothing else moves.
  void make_consistent(double time, double length, Vec u, Tangents& tangents);

private:
  Equations& equations_;
  const solve::Tableau& tableau_;
  Eigen::VectorXd estimate_;           // weights of the error of a step
  Eigen::MatrixXd w_, slopes_, ends_;  // dZ_i, dK_i of all stages, and each direction after the step
  std::unique_ptr<solve::Stage> stage_;
};

}  // namespace whirl::transient
