#include "study/motion/run_up.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "study/cost.hpp"
#include "study/motion/motion_start.hpp"

namespace whirl::study {

double revolutions(const RunUpOptions& o) {
  const double from = o.range.from, to = o.range.to;
  const double duration = o.duration ? o.duration->value : std::abs(to - from) / o.acceleration->value;
  return (from + to) / 2 * duration / (2 * std::numbers::pi);
}

void describe(deck::Description<RunUpOptions>& d) {
  using O = RunUpOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("unbalance", &O::unbalance,
        "names of the unbalances to apply, all at once, and 'discs' for what eccentric and skewed discs do")
      .required();
  d.add("range", &O::range, "rad/s", deck::positive,
        "speeds at the beginning and at the end; falling for a coast-down; results carry its unit")
      .required();
  d.add("acceleration", &O::acceleration, "rad/s^2", deck::positive,
        "size of the shaft's angular acceleration, the same all the time");
  d.add("duration", &O::duration, "s", deck::positive, "time from the first to the second speed, instead");
  d.named("forces", &O::forces, &ForceOptions::name, "external forces over the time since the beginning, by name");
  d.add("start", &O::start, "state at the beginning");
  d.add("nodes", &O::nodes, deck::positive, "nodes of the shaft to report beside the bearings");
  d.add("samples", &O::samples, deck::in(8, 1e5), "samples per revolution, among which extremes are looked for");
  d.add(
      "tolerance", &O::tolerance, deck::in(1e-13, 1e-2),
      "error allowed to a step, in clearances, not below what rounding leaves; with equal steps a hundredth of it ends "
      "Newton's method");
  d.add("integrator", &O::integrator, "scheme of the steps in time");
  d.add("orders", &O::orders, "amplitude and phase of orders of the speed on the way");
  d.add("waterfall", &O::waterfall, "spectra on the way");
  d.add("checkpoint", &O::checkpoint, "write checkpoints to resume from");
  d.check([](const O& o, const deck::Report& r) {
    if (o.acceleration.has_value() == o.duration.has_value())
      return r.fail("", "a run-up has either an 'acceleration' or a 'duration'");
    const double turns = revolutions(o);
    const char* key = o.duration ? "duration" : "acceleration";
    if (turns < 1) r.fail(key, "the shaft does not even turn once on the way");
    constexpr double most = 1e8;
    if (turns > most)
      r.fail(key, fmt::format("the shaft turns {} times on the way; at most {}", deck::write_number(std::round(turns)),
                              deck::write_number(most)));
  });
}

void RunUp::validate(const system::Machine& machine, const deck::Report& report) const {
  check_unbalance(options.unbalance, machine, report);
  check_start(options.start, machine, report);
  check_scheme("integrator.type", options.integrator.scheme, !options.forces.empty(), machine, report);
  check_nodes("nodes", options.nodes, machine, report);
  check_forces("forces", options.forces, machine, report);
  const double turns = revolutions(options);
  if (options.orders) check_orders("orders", *options.orders, turns, options.samples, report);
  if (options.waterfall) check_waterfall("waterfall", *options.waterfall, turns, options.samples, report);
}

double RunUp::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  // Ten numbers a place and revolution, as table, as text and as file.
  const double places = static_cast<double>(machine.bearings.size() + options.nodes.size());
  const double kept = options.orders || options.waterfall ? 64.0 * options.samples : 0;
  return memory_of_equilibria(machine) + (240 + kept) * (places + 1) * revolutions(options);
}

}  // namespace whirl::study
