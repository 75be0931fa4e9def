#include "transient/steps/ts_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "whirl/core/error.hpp"
#include "whirl/core/from_options.hpp"
#include "whirl/core/local_part.hpp"
#include "whirl/core/shell.hpp"

namespace whirl::transient {
namespace {

using core::check;

// A scheme that goes its own pace takes no step longer than this part of a revolution, whose samples are interpolated.
constexpr double longest_part = 1.0 / 16;
constexpr std::size_t most_past = 6;

}  // namespace

SNES TsStepper::snes() const {
  SNES out = nullptr;
  check(TSGetSNES(ts_.get(), &out));
  return out;
}

PetscErrorCode TsStepper::form_residual(TS, PetscReal t, Vec u, Vec udot, Vec f, void* raw) {
  auto& self = *static_cast<TsStepper*>(raw);
  const PetscErrorCode code = self.gate_.run([&] {
    core::get(u, self.value_);
    core::get(udot, self.slope_);
    self.equations_.residual(*self.stage_, t, self.value_, self.slope_, self.f_,
                             self.equations_.stages().derivative_is_free());
    core::put(self.f_, f);
  });
  return self.gate_.domain_error() ? SNESSetFunctionDomainError(self.snes()) : code;
}

PetscErrorCode TsStepper::form_jacobian(TS, PetscReal t, Vec u, Vec udot, PetscReal shift, Mat j, Mat, void* raw) {
  auto& self = *static_cast<TsStepper*>(raw);
  const PetscErrorCode code = self.gate_.run([&] {
    core::get(u, self.value_);
    core::get(udot, self.slope_);
    self.own_ = 1 / shift;
    self.equations_.keep(*self.stage_, t, self.own_, self.value_, self.slope_);
    check(MatAssemblyBegin(j, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(j, MAT_FINAL_ASSEMBLY));
  });
  return self.gate_.domain_error() ? SNESSetJacobianDomainError(self.snes()) : code;
}

void TsStepper::choose(const Scheme& scheme) {
  TS ts = ts_.get();
  TSAdapt adapt = nullptr;
  if (const auto* alpha = std::get_if<GeneralizedAlpha>(&scheme)) {
    check(TSSetType(ts, TSALPHA));
    check(TSAlphaSetRadius(ts, alpha->radius));
    check(TSGetAdapt(ts, &adapt));
    check(TSAdaptSetType(adapt, TSADAPTBASIC));
    pace_ = Pace::by_itself;
  } else if (const auto* bdf = std::get_if<Bdf>(&scheme)) {
    check(TSSetType(ts, TSBDF));
    check(TSBDFSetOrder(ts, bdf->order));
    check(TSGetAdapt(ts, &adapt));
    check(TSAdaptSetType(adapt, TSADAPTBASIC));
    pace_ = Pace::by_itself;
  }
  check(TSSetEquationType(ts, TS_EQ_ODE_IMPLICIT));
  check(TSSetIFunction(ts, nullptr, form_residual, this));
  check(TSSetIJacobian(ts, jacobian_.get(), jacobian_.get(), form_jacobian, this));
}

// [s]
double TsStepper::longest(double time) const {
  return std::min(longest_, longest_part * 2 * std::numbers::pi / std::abs(equations_.drive().speed_at(time)));
}

TsStepper::TsStepper(Equations& equations, const IntegratorOptions& options)
    : equations_(equations),
      gate_(equations.system().comm()),
      stage_(equations.make_stage()),
      u_(equations.make_state()) {
  problem::System& system = equations.system();
  check(TSCreate(system.comm(), ts_.put()));
  TS ts = ts_.get();
  check(TSSetOptionsPrefix(ts, options.prefix.c_str()));
  check(TSSetProblemType(ts, TS_NONLINEAR));
  jacobian_ = core::make_shell(system.comm(), system.local_size(), gate_, {});
  choose(options.scheme);
  check(TSSetTolerances(ts, options.tolerance, nullptr, options.tolerance, nullptr));
  check(TSSetExactFinalTime(ts, TS_EXACTFINALTIME_STEPOVER));
  check(TSSetMaxTime(ts, 1e300));
  check(TSSetMaxSteps(ts, PETSC_MAX_INT));
  check(TSSetMaxSNESFailures(ts, -1));
  check(TSSetMaxStepRejections(ts, max_rejections));
  check(TSSetErrorIfStepFails(ts, PETSC_FALSE));
  // The first guess of a stage is one step away from it. No test of the correction's size: a line search that failed
  // outside the films would pass it.
  const double root_n = std::sqrt(static_cast<double>(system.size()));
  check(SNESSetTolerances(snes(), std::max(1e-2 * options.tolerance, 1e-12) * root_n, 0.1 * options.tolerance, 0, 12,
                          1000));
  check(SNESSetCheckJacobianDomainError(snes(), PETSC_TRUE));  // PETSc looks in debug builds only
  // A Newton step that leaves a film means a time step too long: no line search.
  SNESLineSearch search = nullptr;
  check(SNESGetLineSearch(snes(), &search));
  check(SNESLineSearchSetType(search, SNESLINESEARCHBASIC));
  KSP ksp = nullptr;
  check(SNESGetKSP(snes(), &ksp));
  check(KSPSetType(ksp, KSPPREONLY));
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  core::set_shell(pc, gate_, [this](Vec in, Vec out) {
    core::get(in, f_);
    stage_->solve(f_, equations_.tolerance());
    core::put(own_ * f_, out);
  });
  core::set_from_options(ts);
  TSAdapt adapt = nullptr;
  check(TSGetAdapt(ts, &adapt));
  check(TSAdaptGetStepLimits(adapt, nullptr, &longest_));
  check(TSSetSolution(ts, u_.get()));
  check(TSSetUp(ts));
}

void TsStepper::forget() {
  begun_ = false;
  past_.clear();
  stage_ = equations_.make_stage();
  check(TSRestartStep(ts_.get()));
}

Taken TsStepper::step(double time, double wanted, Vec u) {
  TS ts = ts_.get();
  // A scheme of several steps finds its history as it left it.
  if (pace_ != Pace::by_itself || !begun_) {
    check(TSSetTime(ts, time));
    check(TSSetTimeStep(ts, wanted));
    check(VecCopy(u, u_.get()));
    if (pace_ == Pace::by_itself) remember(time);
  }
  if (pace_ == Pace::by_itself) {
    // A step that was proposed at another speed may be longer than is allowed at this one.
    const double most = longest(time);
    TSAdapt adapt = nullptr;
    check(TSGetAdapt(ts, &adapt));
    check(TSAdaptSetStepLimits(adapt, PETSC_DEFAULT, most));
    PetscReal next = 0;
    check(TSGetTimeStep(ts, &next));
    if (next > most) check(TSSetTimeStep(ts, most));
  }
  gate_.rethrow(TSStep(ts));
  TSConvergedReason reason = TS_CONVERGED_ITERATING;
  PetscReal now = 0, proposed = 0;
  check(TSGetConvergedReason(ts, &reason));
  check(TSGetTime(ts, &now));
  check(TSGetTimeStep(ts, &proposed));
  if (reason < 0 || now == time) {
    begun_ = false;
    if (!gate_.domain_text().empty()) throw core::DomainError(gate_.domain_text());
    throw core::NotConverged(TSConvergedReasons[reason]);
  }
  check(VecCopy(u_.get(), u));
  if (pace_ == Pace::by_itself) {
    begun_ = true;
    remember(now);
    return {now - time, proposed, 0};
  }
  // Late in a motion the time itself is rounded by more than a part of a short step.
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * std::abs(now);
  const bool whole = std::abs(now - time - wanted) <= 1e-9 * wanted + rounding;
  return {whole ? wanted : now - time, proposed, whole ? 0 : 1};
}

void TsStepper::remember(double time) {
  core::Vector copy = past_.size() == most_past ? std::move(past_.back().second) : core::duplicate(u_.get());
  if (past_.size() == most_past) past_.pop_back();
  check(VecCopy(u_.get(), copy.get()));
  past_.emplace_front(time, std::move(copy));
}

void TsStepper::interpolate(double time, Vec u) {
  // The polynomial through the last states: PETSc's own continuation of generalized-alpha is of order one.
  check(VecSet(u, 0));
  for (std::size_t k = 0; k < past_.size(); ++k) {
    double weight = 1;
    for (std::size_t l = 0; l < past_.size(); ++l)
      if (l != k) weight *= (time - past_[l].first) / (past_[k].first - past_[l].first);
    check(VecAXPY(u, weight, past_[k].second.get()));
  }
}

}  // namespace whirl::transient
