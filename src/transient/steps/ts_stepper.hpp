#pragma once
// Steps by PETSc TS.

#include <petscts.h>

#include <deque>
#include <string>

#include "transient/steps/equations.hpp"
#include "transient/steps/stepper.hpp"
#include "whirl/core/gate.hpp"

namespace whirl::transient {

/// Schemes of TS for F(t, u, du/dt) = 0; PETSc's error control chooses their steps.
class TsStepper final : public Stepper {
public:
  TsStepper(Equations& equations, const IntegratorOptions& options);

  [[nodiscard]] Taken step(double time, double wanted, Vec u) override;
  void interpolate(double time, Vec u) override;
  void forget() override;
  [[nodiscard]] Pace pace() const override { return pace_; }

private:
  static PetscErrorCode form_residual(TS ts, PetscReal t, Vec u, Vec udot, Vec f, void* raw);
  static PetscErrorCode form_jacobian(TS ts, PetscReal t, Vec u, Vec udot, PetscReal shift, Mat j, Mat p, void* raw);
  [[nodiscard]] SNES snes() const;
  void choose(const Scheme& scheme);
  [[nodiscard]] double longest(double time) const;
  void remember(double time);

  Equations& equations_;
  core::Gate gate_;  // what callbacks throw leaves PETSc through it
  std::unique_ptr<solve::Stage> stage_;
  double own_ = 0;                     // of its matrix
  Eigen::VectorXd value_, slope_, f_;  // work space of callbacks
  core::Matrix jacobian_;              // known by its inverse only
  core::Vector u_;
  core::Handle<TS, TSDestroy> ts_;
  Pace pace_ = Pace::to_samples;
  double longest_ = 0;                                // [s] by PETSc's options
  bool begun_ = false;                                // a scheme of several steps since forget()
  std::deque<std::pair<double, core::Vector>> past_;  // of a scheme of several steps: its last states, the latest first
};

}  // namespace whirl::transient
