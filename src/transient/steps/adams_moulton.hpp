#pragma once
// A predictor by Adams and Bashforth and a corrector by Adams and Moulton, of order 2.

#include "transient/steps/equations.hpp"
#include "transient/steps/stepper.hpp"

namespace whirl::transient {

/// With f = du/dt of F(t, u, f) = 0 and w = h/h_before,
///
///     p = u_0 + h ((1 + w/2) f_0 - w/2 f_(-1)),   u_1 = u_0 + h/2 (f_0 + f(t_1, p)),   then f_1 = f(t_1, u_1).
///
/// The first step after forget() predicts by f_0 alone. Needs a regular dF/d(du/dt).
class AdamsMoultonSteps final : public Stepper {
public:
  explicit AdamsMoultonSteps(Equations& equations);

  [[nodiscard]] Taken step(double time, double wanted, Vec u) override;
  [[nodiscard]] Pace pace() const override { return Pace::to_samples; }
  void forget() override { before_ = 0; }

private:
  Equations& equations_;
  core::Vector rate_, rate_before_, predicted_, rate_there_, end_;
  double before_ = 0;  // length of the last step; 0: none
};

}  // namespace whirl::transient
