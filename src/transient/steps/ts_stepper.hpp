#pragma once
// Steps by PETSc TS.

#include <petscts.h>

#include <deque>
#include <string>

#include "transient/steps/equations.hpp"
#include "transient/steps/stepper.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::transient {

/// Any scheme of TS for F(t, u, du/dt) = 0; PETSc's error control chooses the steps of those that estimate an error.
class TsStepper final : public Stepper {
public:
  TsStepper(Equations& equations, const IntegratorOptions& options, const solve::Tableau& tableau);

  [[nodiscard]] Taken step(double time, double wanted, Vec u) override;
  void interpolate(double time, Vec u) override;
  void forget() override;
  [[nodiscard]] Pace pace() const override { return pace_; }
  [[nodiscard]] Vec stage(int i) override { return stages_[static_cast<std::size_t>(i)].get(); }

  [[nodiscard]] std::string type() const;

private:
  static PetscErrorCode form_residual(TS ts, PetscReal t, Vec u, Vec udot, Vec f, void* raw);
  static PetscErrorCode form_jacobian(TS ts, PetscReal t, Vec u, Vec udot, PetscReal shift, Mat j, Mat p, void* raw);
  static PetscErrorCode keep_stage(TS ts, PetscReal t, PetscInt stage, Vec* values);
  static PetscErrorCode form_rate(TS ts, PetscReal t, Vec u, Vec rate, void* raw);
  [[nodiscard]] SNES snes() const;
  void choose(const Scheme& scheme);
  [[nodiscard]] double longest(double time) const;
  [[nodiscard]] Taken try_step(double time, double wanted, Vec u);
  void remember(double time);

  Equations& equations_;
  const solve::Tableau& tableau_;
  Eigen::MatrixXd continuous_;  // powers of the part of a step to the weights between its ends
  core::Matrix jacobian_;
  core::Vector u_, start_;
  double start_time_ = 0, length_ = 0;  // of the last step
  std::vector<core::Vector> stages_;
  core::Handle<TS, TSDestroy> ts_;
  Pace pace_ = Pace::to_the_end;
  double longest_ = 0;                                // [s] by PETSc's options
  bool controlled_ = true;                            // PETSc shortens steps that fail
  bool begun_ = false;                                // a scheme of several steps since forget()
  std::string left_;                                  // why an explicit stage could not be evaluated
  std::deque<std::pair<double, core::Vector>> past_;  // of a scheme of several steps: its last states, the latest first
};

}  // namespace whirl::transient
