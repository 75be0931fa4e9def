#include "transient/steps/ts_stepper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "transient/steps/stages.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/from_options.hpp"

namespace whirl::transient {
namespace {

using core::check;

constexpr const char* scheme_name = "whirl_sdirk4";
// A scheme that goes its own pace takes no step longer than this part of a revolution, whose samples are interpolated.
constexpr double longest_part = 1.0 / 16;
constexpr std::size_t most_past = 6;

// PETSc keeps schemes by name for the life of the process.
void register_scheme(const solve::Tableau& t) {
  static const bool done = [&] {
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> a = t.a;
    const Eigen::VectorXd estimate = embedded_weights(t);
    const std::vector<double> none(static_cast<std::size_t>(a.size()), 0.0);
    const auto s = static_cast<PetscInt>(t.stages());
    check(TSARKIMEXRegister(scheme_name, t.order, s, a.data(), t.b.data(), t.c.data(), none.data(), none.data(),
                            t.c.data(), estimate.data(), none.data(), 0, nullptr, nullptr));
    return true;
  }();
  (void)done;
}

}  // namespace

SNES TsStepper::snes() const {
  SNES out = nullptr;
  check(TSGetSNES(ts_.get(), &out));
  return out;
}

PetscErrorCode TsStepper::form_residual(TS, PetscReal t, Vec u, Vec udot, Vec f, void* raw) {
  auto& self = *static_cast<TsStepper*>(raw);
  core::Gate& gate = self.equations_.gate();
  const PetscErrorCode code = gate.run([&] { self.equations_.residual(t, u, udot, f); });
  return gate.domain_error() ? SNESSetFunctionDomainError(self.snes()) : code;
}

PetscErrorCode TsStepper::form_jacobian(TS, PetscReal t, Vec u, Vec udot, PetscReal shift, Mat j, Mat, void* raw) {
  auto& self = *static_cast<TsStepper*>(raw);
  core::Gate& gate = self.equations_.gate();
  const PetscErrorCode code = gate.run([&] { self.equations_.jacobian(t, u, udot, 1, shift, j); });
  return gate.domain_error() ? SNESSetJacobianDomainError(self.snes()) : code;
}

// PETSc gives no place for a context of its own here.
PetscErrorCode TsStepper::keep_stage(TS ts, PetscReal, PetscInt stage, Vec* values) {
  void* raw = nullptr;
  PetscCall(TSGetApplicationContext(ts, &raw));
  auto& self = *static_cast<TsStepper*>(raw);
  if (static_cast<std::size_t>(stage) >= self.stages_.size()) return 0;
  return VecCopy(values[stage], self.stages_[static_cast<std::size_t>(stage)].get());
}

PetscErrorCode TsStepper::form_rate(TS, PetscReal t, Vec u, Vec rate, void* raw) {
  auto& self = *static_cast<TsStepper*>(raw);
  core::Gate& gate = self.equations_.gate();
  if (!self.left_.empty()) return VecSet(rate, 0);
  const PetscErrorCode code = gate.run([&] { self.equations_.rate(t, u, rate); });
  if (!gate.domain_error()) return code;
  self.left_ = gate.domain_text();  // the step is worth nothing
  return VecSet(rate, 0);
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
  } else if (std::holds_alternative<RungeKutta4>(scheme)) {
    check(TSSetEquationType(ts, TS_EQ_EXPLICIT));
    check(TSSetType(ts, TSRK));
    check(TSRKSetType(ts, TSRK4));
    check(TSSetRHSFunction(ts, nullptr, form_rate, this));
    check(TSGetAdapt(ts, &adapt));
    check(TSAdaptSetType(adapt, TSADAPTNONE));
    pace_ = Pace::to_samples;
    controlled_ = false;
    return;
  } else {
    check(TSSetType(ts, TSARKIMEX));
    check(TSARKIMEXSetType(ts, scheme_name));
    check(TSARKIMEXSetFullyImplicit(ts, PETSC_TRUE));
  }
  check(TSSetEquationType(ts, TS_EQ_ODE_IMPLICIT));
  check(TSSetIFunction(ts, nullptr, form_residual, this));
  check(TSSetIJacobian(ts, jacobian_.get(), jacobian_.get(), form_jacobian, this));
}

// [s]
double TsStepper::longest(double time) const {
  return std::min(longest_, longest_part * 2 * std::numbers::pi / std::abs(equations_.drive().speed_at(time)));
}

TsStepper::TsStepper(Equations& equations, const IntegratorOptions& options, const solve::Tableau& tableau)
    : equations_(equations),
      tableau_(tableau),
      continuous_(continuous_weights(tableau)),
      jacobian_(equations.make_matrix()),
      u_(equations.make_state()),
      start_(equations.make_state()) {
  register_scheme(tableau);
  for (Eigen::Index i = 0; i < tableau.stages(); ++i) stages_.push_back(equations.make_state());
  problem::System& system = equations.system();
  check(TSCreate(system.comm(), ts_.put()));
  TS ts = ts_.get();
  check(TSSetOptionsPrefix(ts, options.prefix.c_str()));
  check(TSSetProblemType(ts, TS_NONLINEAR));
  choose(options.scheme);
  check(TSSetApplicationContext(ts, this));
  check(TSSetPostStage(ts, keep_stage));
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
  equations.configure(ksp);
  core::set_from_options(ts);
  TSAdapt adapt = nullptr;
  check(TSGetAdapt(ts, &adapt));
  check(TSAdaptGetStepLimits(adapt, nullptr, &longest_));
  // Other schemes by PETSc's options: their own interpolation may be missing.
  if (pace_ == Pace::to_the_end && type() != TSARKIMEX) pace_ = Pace::to_samples;
  check(TSSetSolution(ts, u_.get()));
  check(TSSetUp(ts));
}

void TsStepper::forget() {
  begun_ = false;
  past_.clear();
  check(TSRestartStep(ts_.get()));
}

Taken TsStepper::try_step(double time, double wanted, Vec u) {
  TS ts = ts_.get();
  core::Gate& gate = equations_.gate();
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
  left_.clear();
  gate.rethrow(TSStep(ts));
  TSConvergedReason reason = TS_CONVERGED_ITERATING;
  PetscReal now = 0, proposed = 0;
  check(TSGetConvergedReason(ts, &reason));
  check(TSGetTime(ts, &now));
  check(TSGetTimeStep(ts, &proposed));
  if (!left_.empty()) throw core::DomainError(left_);
  if (reason < 0 || now == time) {
    begun_ = false;
    if (!gate.domain_text().empty()) throw core::DomainError(gate.domain_text());
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

Taken TsStepper::step(double time, double wanted, Vec u) {
  check(VecCopy(u, start_.get()));
  start_time_ = time;
  if (controlled_) {
    const Taken taken = try_step(time, wanted, u);
    length_ = taken.length;
    return taken;
  }
  // PETSc has no error to control here, and so no way to shorten a step that leaves a film.
  const Taken taken = take_step(wanted, 1, [&](double h) -> std::optional<double> {
    (void)try_step(time, h, u);
    return 0.0;
  });
  return {taken.length, taken.length, taken.rejected, taken.why};
}

void TsStepper::interpolate(double time, Vec u) {
  if (pace_ == Pace::to_the_end) {
    // u_0 + h sum b_i(theta) K_i; PETSc's own takes the first stage for u_0, which holds for explicit ones only.
    const double part = (time - start_time_) / length_;
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(tableau_.stages());
    for (Eigen::Index p = continuous_.cols() - 1; p >= 0; --p) weights = part * (weights + continuous_.col(p));
    // With h K = A^-1 (Y - u_0).
    weights = core::DenseLu<double>(tableau_.a).solve_transposed(weights);
    check(VecCopy(start_.get(), u));
    check(VecScale(u, 1 - weights.sum()));
    for (std::size_t i = 0; i < stages_.size(); ++i)
      check(VecAXPY(u, weights(static_cast<Eigen::Index>(i)), stages_[i].get()));
    return;
  }
  // The polynomial through the last states: PETSc's own continuation of generalized-alpha is of order one.
  check(VecSet(u, 0));
  for (std::size_t k = 0; k < past_.size(); ++k) {
    double weight = 1;
    for (std::size_t l = 0; l < past_.size(); ++l)
      if (l != k) weight *= (time - past_[l].first) / (past_[k].first - past_[l].first);
    check(VecAXPY(u, weight, past_[k].second.get()));
  }
}

std::string TsStepper::type() const {
  TSType type = nullptr;
  check(TSGetType(ts_.get(), &type));
  return type;
}

}  // namespace whirl::transient
