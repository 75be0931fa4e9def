#include "whirl/transient/steps/integrator.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "transient/steps/equations.hpp"
#include "transient/steps/explicit_steps.hpp"
#include "transient/steps/gauss.hpp"
#include "transient/steps/newmark.hpp"
#include "transient/steps/sdirk_steps.hpp"
#include "transient/steps/stages.hpp"
#include "transient/steps/ts_stepper.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::transient {
namespace {

using core::check;

// Growth rates are wanted to fewer digits than the motion: two, at the step's estimate of order three, which is
// pessimistic for a solution of order four.
constexpr double deviation_tolerance = 100;
// Of a step, in which deviations become consistent where some states have no rates.
constexpr double consistent_part = 1e-6;
// A proposal that changes the step by less keeps it, and with it the factors of its matrices.
constexpr double least_change = 0.95, largest_kept = 1.2;
// In revolutions. A film that closes lets steps shrink with it for ever, and each of them succeeds.
constexpr double shortest_step = 1e-13;

// -PREFIXassembled takes the other path, for comparison.
Algebra algebra_of(const IntegratorOptions& o) {
  const bool assembled = core::plan::assembles_steps(o.prefix, o.algebra == Algebra::assembled);
  return assembled ? Algebra::assembled : Algebra::automatic;
}

}  // namespace

struct Integrator::Parts {
  Parts(problem::System& system, const problem::Drive& given, const IntegratorOptions& o)
      : drive(given), options(o), equations(system, given, algebra_of(o)), tableau(solve::sdirk(4)) {}

  problem::Drive drive;
  IntegratorOptions options;
  Equations equations;
  solve::Tableau tableau;
  core::Vector u;              // as told, and
  core::Vector front, before;  // at the end of the last step, and at its beginning
  std::unique_ptr<Stepper> stepper;
  SdirkSteps* sdirk = nullptr;  // the stepper if it is this
  std::unique_ptr<StageTangents> carrier;
  Tangents* tangents = nullptr;
  bool algebraic = false;                  // some states have no rates, where deviations are carried
  double time = 0, reached = 0, step = 0;  // told, of the front, proposed
  double offset = 0;                       // of the stepper's time before these
  bool by_revolutions = false;             // `time` begins anew with each
  long steps = 0, rejected = 0;
  std::string why = "the cause is not known";  // an attempt was last rejected

  void choose();
  [[nodiscard]] std::string where() const {
    return fmt::format("the motion could not be continued beyond {}{:.9g} s{}: ", by_revolutions ? "" : "t = ", reached,
                       by_revolutions ? " of the revolution" : "");
  }
  void stop_at_front() {
    check(VecCopy(front.get(), u.get()));
    time = reached;
  }
  // One step towards `end`. What is told of a motion that ends is its end.
  void take(double end) {
    try {
      go_on(end);
    } catch (const core::DomainError& e) {
      stop_at_front();
      throw core::DomainError(where() + e.what());
    } catch (const core::NotConverged& e) {
      stop_at_front();
      throw core::NotConverged(where() + e.what());
    }
  }
  // The same with deviations only where they allow it.
  void go_on(double end) {
    const Pace pace = stepper->pace();
    if (const int wanted_steps = equal_steps(options.scheme))
      step = 2 * std::numbers::pi / (std::abs(drive.speed_at(reached)) * wanted_steps);
    // A step ends at a break of the forces; one that is nearer than rounding is none.
    bool breaks = false;
    if (options.forces) {
      const double slack = 1e-9 * step, next = options.forces->next_break(reached + slack);
      breaks = next <= end + slack;
      if (next < end - slack) end = next;
    }
    const double left = pace == Pace::by_itself ? step : end - reached;
    // Equal steps to the end, so that none of them is short for nothing.
    const double parts = std::max(1.0, std::ceil(left / step * (1 - 1e-9)));
    const double wanted = left / parts;
    if (options.forces) options.forces->enter(reached, reached + wanted);
    check(VecCopy(front.get(), before.get()));
    Taken taken = stepper->step(reached + offset, wanted, front.get());
    rejected += taken.rejected;
    if (!taken.why.empty()) why = taken.why;
    if (std::max(taken.length, taken.proposed) <
        shortest_step * 2 * std::numbers::pi / std::abs(drive.speed_at(reached))) {
      check(VecCopy(before.get(), front.get()));
      throw core::DomainError(fmt::format("steps shorter than {:.0e} revolutions: {}", shortest_step, why));
    }
    if (tangents) {
      // The steps suit the deviations too: at an equilibrium the state alone would allow any.
      const double error = carrier->propagate(reached + offset, taken.length, *sdirk, *tangents) /
                           (deviation_tolerance * options.tolerance);
      const double allowed = allowed_step(taken.length, error, tableau.order);
      if (error > 1) {
        check(VecCopy(before.get(), front.get()));
        stepper->forget();
        step = allowed;
        ++rejected;
        return;
      }
      carrier->accept(*tangents);
      taken.proposed = std::min(taken.proposed, allowed);
    }
    const double length = taken.length;
    // Growth stops at a factor of ten: a step cut short for the end of the interval then says nothing.
    if (pace == Pace::by_itself)
      step = taken.proposed;
    else if (taken.proposed > 9.9 * length)
      step = std::max(step, taken.proposed);
    else if (taken.rejected > 0 || taken.proposed < least_change * length || taken.proposed > largest_kept * length)
      step = taken.proposed;
    reached = pace != Pace::by_itself && length == wanted && parts == 1 ? end : reached + length;
    if (breaks && reached == end) stepper->pass_break();
    ++steps;
    if (options.after_step) options.after_step(reached, length);
  }
};

void Integrator::Parts::choose() {
  const Scheme& s = options.scheme;
  core::require(!options.forces || !has_own_pace(s), "no step of such a scheme ends at a break of external forces");
  const double newton = std::max(1e-2 * options.tolerance, 1e-13);
  const bool fixed_point = std::holds_alternative<NewmarkFixedPoint>(s),
             linearised = std::holds_alternative<NewmarkLinearised>(s),
             newmark = fixed_point || linearised || std::holds_alternative<Newmark>(s);
  const std::string singular = newmark || is_explicit(s) ? equations.why_singular(0, u.get()) : "";
  if (is_explicit(s) && !singular.empty())
    throw core::InputError(
        fmt::format("the explicit scheme {} needs a rate of every state, but equations of {} hold none: dF/d(dx/dt) is "
                    "singular; sdirk4, bdf, generalized_alpha and newmark do without",
                    name_of(s), singular));
  if (fixed_point && !equations.thin())
    throw core::InputError(fmt::format(
        "{} iterates over the forces of films of a rotor that one rank holds whole; newmark does without", name_of(s)));
  if (fixed_point)
    stepper = std::make_unique<NewmarkFixedPointSteps>(equations, singular.empty(), newton);
  else if (newmark)
    stepper = std::make_unique<NewmarkSteps>(equations, linearised, singular.empty(), newton);
  else if (std::holds_alternative<AdamsMoulton>(s))
    stepper = std::make_unique<AdamsMoultonSteps>(equations);
  else if (std::holds_alternative<RungeKutta4>(s))
    stepper = std::make_unique<ClassicalSteps>(equations);
  else if (const auto* irk = std::get_if<Irk>(&s))
    stepper = std::make_unique<GaussSteps>(equations, irk->stages, newton);
  else if (has_own_pace(s) || core::plan::steps_by_petsc(options.prefix))
    stepper = std::make_unique<TsStepper>(equations, options);
  else
    stepper.reset(sdirk = new SdirkSteps(equations, tableau, options.tolerance));
}

Integrator::Integrator(problem::System& system, problem::Drive drive, Vec x, IntegratorOptions options)
    : parts_(std::make_unique<Parts>(system, drive, options)) {
  Parts& p = *parts_;
  p.u = p.equations.make_state();
  p.front = p.equations.make_state();
  p.before = p.equations.make_state();
  p.step = options.first_step > 0 ? options.first_step : 2e-3 * std::numbers::pi / std::abs(system.speed());
  p.equations.scale(x, p.u.get());
  p.equations.act(options.forces);
  p.choose();
  restart(0, p.step);
}

Integrator::~Integrator() = default;

void Integrator::carry(Tangents* tangents) {
  Parts& p = *parts_;
  if (tangents && !p.sdirk) throw core::InputError("Lyapunov exponents need the scheme sdirk4");
  core::require(!tangents || p.reached == p.time, "deviations begin at the end of a step");
  p.tangents = tangents;
  if (tangents && !p.carrier) {
    p.carrier = std::make_unique<StageTangents>(p.equations, p.tableau);
    p.algebraic = !p.equations.why_singular(p.reached + p.offset, p.front.get()).empty();
  }
  if (!tangents || !tangents->are_new()) return;
  if (p.algebraic) p.carrier->make_consistent(p.reached + p.offset, consistent_part * p.step, p.front.get(), *tangents);
  tangents->were_carried();
}

void Integrator::restart(double time, double step) {
  Parts& p = *parts_;
  p.time = p.reached = time;
  p.offset = 0;
  p.step = step;
  check(VecCopy(p.u.get(), p.front.get()));
  p.stepper->forget();
  p.equations.forget();
  if (p.carrier) p.carrier->forget();
}

void Integrator::close_revolution(double earlier) {
  Parts& p = *parts_;
  p.by_revolutions = earlier > 0;
  if (p.stepper->pace() != Pace::by_itself) return restart(p.time - earlier, p.step);
  p.time -= earlier;
  p.reached -= earlier;
  p.offset += earlier;
}

void Integrator::advance(double time) {
  advance(time, time);
}

void Integrator::advance(double time, double end) {
  Parts& p = *parts_;
  if (p.tangents || p.stepper->pace() == Pace::to_samples) end = time;
  while (p.reached < time) p.take(std::max(time, end));
  p.time = time;
  if (p.reached == time)
    check(VecCopy(p.front.get(), p.u.get()));
  else
    p.stepper->interpolate(time + p.offset, p.u.get());
}

bool Integrator::goes_its_own_pace() const {
  return parts_->stepper->pace() == Pace::by_itself;
}

void Integrator::advance_within_step(double time) {
  Parts& p = *parts_;
  core::require(goes_its_own_pace(), "a scheme whose steps end where they are told to");
  if (p.reached <= p.time) p.take(time);
  advance(std::min(time, p.reached));
}

std::unique_ptr<Integrator> Integrator::twin() const {
  const Parts& p = *parts_;
  IntegratorOptions options = p.options;
  options.after_step = nullptr;
  options.first_step = p.step;
  const core::Vector x = p.equations.make_state();
  state(x.get());
  return std::make_unique<Integrator>(p.equations.system(), p.drive, x.get(), std::move(options));
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
  const Parts& p = *parts_;
  return {p.steps, p.rejected, p.equations.residuals(), p.equations.jacobians(), p.equations.stages().factorisations()};
}

}  // namespace whirl::transient
