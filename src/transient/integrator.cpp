#include "whirl/transient/integrator.hpp"

#include <fmt/core.h>
#include <petscts.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "transient/equations.hpp"
#include "transient/stages.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/gate.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::transient {
namespace {

using core::check;

constexpr const char* scheme_name = "whirl_sdirk4";
// Each rejection divides the step by at least four where a film was left, by up to ten otherwise.
constexpr int max_rejections = 20;

// Growth rates are wanted to fewer digits than the motion: two, at the step's estimate of order three, which is
// pessimistic for a solution of order four.
constexpr double deviation_tolerance = 100;

// -PREFIXassembled takes the other path: for comparison, and for what needs a matrix (TSIRK).
Algebra algebra_of(const IntegratorOptions& o) {
  PetscBool assembled = o.algebra == Algebra::assembled ? PETSC_TRUE : PETSC_FALSE;
  check(PetscOptionsGetBool(nullptr, o.prefix.c_str(), "-assembled", &assembled, nullptr));
  return assembled ? Algebra::assembled : Algebra::automatic;
}

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

struct Integrator::Parts {
  Parts(problem::System& system, const problem::Drive& given, const IntegratorOptions& o)
      : drive(given),
        options(o),
        equations(system, given, algebra_of(o)),
        gate(equations.gate()),
        tableau(solve::sdirk(4)) {}

  problem::Drive drive;
  IntegratorOptions options;
  Equations equations;
  core::Gate& gate;
  solve::Tableau tableau;
  core::Vector u, before;
  core::Matrix jacobian;
  core::Handle<TS, TSDestroy> ts;
  std::unique_ptr<StageTangents> carrier;
  Tangents* tangents = nullptr;
  double time = 0, step = 0;
  Work work;
};

namespace {

template <class Parts>
SNES snes_of(Parts& p) {
  SNES snes = nullptr;
  check(TSGetSNES(p.ts.get(), &snes));
  return snes;
}

template <class Parts>
PetscErrorCode form_residual(TS, PetscReal t, Vec u, Vec udot, Vec f, void* raw) {
  auto& p = *static_cast<Parts*>(raw);
  ++p.work.residuals;
  const PetscErrorCode code = p.gate.run([&] { p.equations.residual(t, u, udot, f); });
  return p.gate.domain_error() ? SNESSetFunctionDomainError(snes_of(p)) : code;
}

template <class Parts>
PetscErrorCode form_jacobian(TS, PetscReal t, Vec u, Vec udot, PetscReal shift, Mat j, Mat, void* raw) {
  auto& p = *static_cast<Parts*>(raw);
  ++p.work.jacobians;
  const PetscErrorCode code = p.gate.run([&] { p.equations.jacobian(t, u, udot, 1, shift, j); });
  return p.gate.domain_error() ? SNESSetJacobianDomainError(snes_of(p)) : code;
}

// PETSc gives no place for a context of its own here.
template <class Parts>
PetscErrorCode keep_stage(TS ts, PetscReal, PetscInt stage, Vec* values) {
  void* raw = nullptr;
  PetscCall(TSGetApplicationContext(ts, &raw));
  auto& p = *static_cast<Parts*>(raw);
  if (!p.tangents) return 0;
  return p.gate.run([&] { p.carrier->keep(stage, values[stage]); });
}

}  // namespace

Integrator::Integrator(problem::System& system, problem::Drive drive, Vec x, IntegratorOptions options)
    : parts_(std::make_unique<Parts>(system, drive, options)) {
  Parts& p = *parts_;
  register_scheme(p.tableau);
  p.u = p.equations.make_state();
  p.before = core::duplicate(p.u.get());
  p.jacobian = p.equations.make_matrix();
  p.step = options.first_step > 0 ? options.first_step : 2e-3 * std::numbers::pi / std::abs(system.speed());
  p.equations.scale(x, p.u.get());
  p.equations.act(options.forces);

  TS* made = p.ts.put();
  check(TSCreate(system.comm(), made));
  TS ts = p.ts.get();
  check(TSSetOptionsPrefix(ts, options.prefix.c_str()));
  check(TSSetProblemType(ts, TS_NONLINEAR));
  check(TSSetEquationType(ts, TS_EQ_ODE_IMPLICIT));
  check(TSSetType(ts, TSARKIMEX));
  check(TSARKIMEXSetType(ts, scheme_name));
  check(TSARKIMEXSetFullyImplicit(ts, PETSC_TRUE));
  check(TSSetIFunction(ts, nullptr, form_residual<Parts>, &p));
  check(TSSetIJacobian(ts, p.jacobian.get(), p.jacobian.get(), form_jacobian<Parts>, &p));
  check(TSSetApplicationContext(ts, &p));
  check(TSSetPostStage(ts, keep_stage<Parts>));
  check(TSSetTolerances(ts, options.tolerance, nullptr, options.tolerance, nullptr));
  check(TSSetExactFinalTime(ts, TS_EXACTFINALTIME_STEPOVER));
  check(TSSetMaxTime(ts, 1e300));
  check(TSSetMaxSteps(ts, PETSC_MAX_INT));
  check(TSSetMaxSNESFailures(ts, -1));
  check(TSSetMaxStepRejections(ts, max_rejections));
  check(TSSetErrorIfStepFails(ts, PETSC_FALSE));
  SNES snes = snes_of(p);
  // The first guess of a stage is one step away from it. No test of the correction's size: a line search that failed
  // outside the films would pass it.
  const double root_n = std::sqrt(static_cast<double>(system.size()));
  check(SNESSetTolerances(snes, std::max(1e-2 * options.tolerance, 1e-12) * root_n, 0.1 * options.tolerance, 0, 12,
                          1000));
  check(SNESSetCheckJacobianDomainError(snes, PETSC_TRUE));  // PETSc looks in debug builds only
  // A Newton step that leaves a film means a time step too long: no line search.
  SNESLineSearch search = nullptr;
  check(SNESGetLineSearch(snes, &search));
  check(SNESLineSearchSetType(search, SNESLINESEARCHBASIC));
  KSP ksp = nullptr;
  check(SNESGetKSP(snes, &ksp));
  p.equations.configure(ksp);
  check(TSSetFromOptions(ts));
  check(TSSetSolution(ts, p.u.get()));
  check(TSSetUp(ts));
}

Integrator::~Integrator() = default;

void Integrator::carry(Tangents* tangents) {
  Parts& p = *parts_;
  TSType type = nullptr;
  check(TSGetType(p.ts.get(), &type));
  if (tangents && std::string(type) != TSARKIMEX)
    throw core::InputError("Lyapunov exponents need the scheme of this program, not -" + p.options.prefix + "ts_type " +
                           type);
  p.tangents = tangents;
  if (tangents && !p.carrier) p.carrier = std::make_unique<StageTangents>(p.equations, p.tableau);
}

void Integrator::restart(double time, double step) {
  parts_->time = time;
  parts_->step = step;
}

void Integrator::advance(double time) {
  Parts& p = *parts_;
  TS ts = p.ts.get();
  check(TSRestartStep(ts));
  while (p.time < time) {
    // A step ends at a break of the forces; one that is nearer than rounding is none.
    double end = time;
    if (p.options.forces) {
      const double slack = 1e-9 * p.step, next = p.options.forces->next_break(p.time + slack);
      if (next < time - slack) end = next;
    }
    const double left = end - p.time;
    // Equal steps to the end, so that none of them is short for nothing.
    const double parts = std::max(1.0, std::ceil(left / p.step * (1 - 1e-9)));
    const double wanted = left / parts;
    if (p.options.forces) p.options.forces->enter(p.time, p.time + wanted);
    check(TSSetTime(ts, p.time));
    check(TSSetTimeStep(ts, wanted));
    check(VecCopy(p.u.get(), p.before.get()));
    p.gate.rethrow(TSStep(ts));
    TSConvergedReason reason = TS_CONVERGED_ITERATING;
    PetscReal now = 0, proposed = 0;
    check(TSGetConvergedReason(ts, &reason));
    check(TSGetTime(ts, &now));
    check(TSGetTimeStep(ts, &proposed));
    if (reason < 0 || now == p.time) {
      check(VecCopy(p.before.get(), p.u.get()));
      const std::string where = fmt::format("the motion could not be continued beyond t = {:.9g} s", p.time);
      if (!p.gate.domain_text().empty()) throw core::DomainError(where + ": " + p.gate.domain_text());
      throw core::NotConverged(fmt::format("{}: {}", where, TSConvergedReasons[reason]));
    }
    const bool whole = std::abs(now - p.time - wanted) < 1e-9 * wanted;
    if (!whole) ++p.work.rejected;
    const double length = whole ? wanted : now - p.time;
    if (p.tangents) {
      // The steps suit the deviations too: at an equilibrium the state alone would allow any.
      const double error = p.carrier->propagate(p.time, length, p.before.get(), *p.tangents) /
                           (deviation_tolerance * p.options.tolerance);
      const double allowed = length * std::clamp(0.9 * std::pow(error, -0.25), 0.1, 10.0);
      if (error > 1) {
        check(VecCopy(p.before.get(), p.u.get()));
        p.step = allowed;
        ++p.work.rejected;
        continue;
      }
      p.carrier->accept(*p.tangents);
      proposed = std::min(proposed, allowed);
    }
    // Growth stops at a factor of ten: a step cut short for the end of the interval then says nothing.
    p.step = proposed > 9.9 * length ? std::max(p.step, proposed) : proposed;
    p.time = whole && parts == 1 ? end : now;
    if (p.time == end && end < time) check(TSRestartStep(ts));  // for schemes that remember what was before the break
    ++p.work.steps;
    if (p.options.after_step) p.options.after_step(p.time, length);
  }
}

double Integrator::time() const {
  return parts_->time;
}

double Integrator::step() const {
  return parts_->step;
}

void Integrator::state(Vec x) const {
  parts_->equations.unscale(parts_->u.get(), x);
}

Vec Integrator::scaled() const {
  return parts_->u.get();
}

const problem::Drive& Integrator::drive() const {
  return parts_->drive;
}

Integrator::Work Integrator::work() const {
  return parts_->work;
}

}  // namespace whirl::transient
