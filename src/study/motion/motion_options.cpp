#include <fmt/core.h>

#include "study/cost.hpp"
#include "study/motion/motion.hpp"
#include "study/motion/motion_start.hpp"
#include "whirl/film/contract/options.hpp"

namespace whirl::study {

std::span<const deck::Name<MotionStart::From>> names(MotionStart::From) {
  using enum MotionStart::From;
  static constexpr deck::Name<MotionStart::From> table[] = {
      {equilibrium, "equilibrium", "where the balanced machine sits"},
      {cycle, "cycle", "the synchronous cycle of the unbalanced machine, stable or not, with its multipliers"},
      {centre, "centre", "the journal of a rigid rotor on one bearing, at rest in the centre of it"}};
  return table;
}

void describe(deck::Description<MotionStart>& d) {
  d.add("from", &MotionStart::from, "where the motion begins");
  d.add("offset", &MotionStart::offset, "1", deck::in(-1, 1),
        "displacement of every journal from there in x and y, per clearance");
}

void describe(deck::Description<MotionOptions>& d) {
  using O = MotionOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("unbalance", &O::unbalance,
        "names of the unbalances to apply, all at once, and 'discs' for what eccentric and skewed discs do; none for "
        "the balanced machine");
  d.add("speed", &O::speed, "rad/s", deck::positive, "shaft speed").required().alias("speeds");
  d.named("forces", &O::forces, &ForceOptions::name, "external forces over the time since the beginning, by name");
  d.add("start", &O::start, "state at the beginning");
  d.add("discard", &O::discard, deck::in(0, 1e9), "revolutions before anything is recorded");
  d.add("revolutions", &O::revolutions, deck::in(2, 1e8), "revolutions recorded");
  d.add("samples", &O::samples, deck::in(8, 1e5), "samples per revolution, of orbits and spectra");
  d.add(
      "tolerance", &O::tolerance, deck::in(1e-13, 1e-2),
      "error allowed to a step, in clearances, not below what rounding leaves; with equal steps a hundredth of it ends "
      "Newton's method");
  d.add("integrator", &O::integrator, "scheme of the steps in time");
  d.add("exponents", &O::exponents, deck::in(0, 1e4), "Lyapunov exponents to compute, the largest; none: 0");
  d.add("max_period", &O::max_period, deck::in(1, 1e5), "longest period to look for, in revolutions");
  d.add("return_tolerance", &O::return_tolerance, deck::in(1e-13, 1),
        "distance between Poincare points, relative to the size of the motion, below which it repeats itself");
  d.add("window", &O::window, "what multiplies the record before its Fourier transform");
  d.add("orbit", &O::orbit, deck::non_negative, "revolutions whose orbit is stored, the last ones");
  d.add(
      "section", &O::section,
      "Poincare section by a plane in the states; without it the points of a motion that nothing forces lie where the "
      "coordinate that travels most passes its mean");
  d.add("orders", &O::orders, "amplitude and phase of orders of the speed over the course of the motion");
  d.add("waterfall", &O::waterfall, "spectra over the course of the motion");
  d.add("checkpoint", &O::checkpoint, "write checkpoints to resume from");
}

void check_start(const MotionStart& start, const system::Machine& machine, const deck::Report& report) {
  if (start.from != MotionStart::From::centre) return;
  if (machine.bearings.size() != 1 || machine.rotor.type != rotor::Options::Type::rigid)
    return report.fail("start.from",
                       "only a rigid rotor on one bearing can be let go from the centre of its bearing: begin at the "
                       "equilibrium, with an 'offset'");
  if (film::facts(machine.bearings.front().film).coefficients)
    report.fail("start.from", "a linear film knows no centre of its bearing: begin at the equilibrium");
}

void check_scheme(const std::string& key, const transient::Scheme& scheme, bool forced, const system::Machine& machine,
                  const deck::Report& report) {
  if (forced && transient::has_own_pace(scheme))
    report.fail(key, fmt::format("{} keeps a history of several steps, which end at no break of external forces: take "
                                 "sdirk4 or a scheme of equal steps",
                                 transient::name_of(scheme)));
  if (!transient::is_explicit(scheme)) return;
  for (const auto& b : machine.bearings)
    // Where the gap is full its pressure follows the journal at once.
    if (film::find<film::Reynolds>(b.film) && film::facts(b.film).own_states)
      report.fail(
          key,
          fmt::format("an explicit scheme needs a rate of every state, and pressures of a film that conserves its mass "
                      "have none (bearing {}): take sdirk4, bdf, generalized_alpha or newmark",
                      b.name));
}

void Motion::validate(const system::Machine& machine, const deck::Report& report) const {
  check_start(options.start, machine, report);
  if (!options.unbalance.empty()) check_unbalance(options.unbalance, machine, report);
  if (options.unbalance.empty() && options.start.from == MotionStart::From::cycle)
    report.fail("start.from", "a balanced machine has no synchronous cycle to start from");
  check_forces("forces", options.forces, machine, report);
  if (options.section) check_section("section", *options.section, machine, report);
  if (options.orders) check_orders("orders", *options.orders, options.revolutions, options.samples, report);
  if (options.waterfall) check_waterfall("waterfall", *options.waterfall, options.revolutions, options.samples, report);
  check_scheme("integrator.type", options.integrator.scheme, !options.forces.empty(), machine, report);
  if (options.exponents > 0 && !std::holds_alternative<transient::Sdirk4>(options.integrator.scheme))
    report.fail("exponents",
                fmt::format("Lyapunov exponents are carried along by sdirk4 only; with {} say `exponents: 0`",
                            transient::name_of(options.integrator.scheme)));
  if (const auto forcing = system::own_forcing(machine); forcing && options.speed.value != *forcing)
    report.fail("speed", fmt::format("a motion of '{}' goes by the periods of its force: its speed is {:.12g} rad/s",
                                     system::name_of(machine.system), *forcing));
}

double Motion::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  const double places = static_cast<double>(machine.bearings.size()) + 1;
  return memory_of_equilibria(machine) + 70 * places * options.revolutions * options.samples;
}

}  // namespace whirl::study
