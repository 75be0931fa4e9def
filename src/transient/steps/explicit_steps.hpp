#pragma once
// Steps by rates that follow from states alone.

#include "transient/steps/equations.hpp"
#include "transient/steps/stepper.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::transient {

/// With f = du/dt of F(t, u, f) = 0 and w = h/h_before,
///
///     p = u_0 + h ((1 + w/2) f_0 - w/2 f_(-1)),   u_1 = u_0 + h/2 (f_0 + f(t_1, p)),   then f_1 = f(t_1, u_1).
///
/// The first step after forget() predicts by f_0 alone. Needs a regular dF/d(du/dt).
class AdamsMoultonSteps final : public Stepper {
public:
  explicit AdamsMoultonSteps(Equations& equations) : equations_(equations) {}

  [[nodiscard]] Taken step(double time, double wanted, Vec u) override;
  [[nodiscard]] Pace pace() const override { return Pace::to_samples; }
  void forget() override { before_ = 0; }

private:
  Equations& equations_;
  Eigen::VectorXd start_, rate_, rate_before_, rate_there_, end_;
  double before_ = 0;  // length of the last step; 0: none
};

/// The classical scheme of order 4. Needs a regular dF/d(du/dt).
class ClassicalSteps final : public Stepper {
public:
  explicit ClassicalSteps(Equations& equations) : equations_(equations) {}

  [[nodiscard]] Taken step(double time, double wanted, Vec u) override;
  [[nodiscard]] Pace pace() const override { return Pace::to_samples; }
  void forget() override {}

private:
  Equations& equations_;
  const solve::Tableau tableau_ = solve::classical();
  Eigen::VectorXd start_, value_, rate_;
  Eigen::MatrixXd slopes_;  // [n x stages]
};

}  // namespace whirl::transient
