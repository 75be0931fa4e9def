#include "whirl/study/run_up.hpp"

namespace whirl::study {

void describe(deck::Description<RunUpOptions>& d) {
  using O = RunUpOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("unbalance", &O::unbalance, "names of the unbalances to apply, all at once").required();
  d.add("range", &O::range, "rad/s", deck::positive,
        "speeds at the beginning and at the end; falling for a coast-down; results carry its unit")
      .required();
  d.add("acceleration", &O::acceleration, "rad/s^2", deck::positive,
        "size of the shaft's angular acceleration, the same all the time");
  d.add("duration", &O::duration, "s", deck::positive, "time from the first to the second speed, instead");
  d.add("start", &O::start, "state at the beginning");
  d.add("nodes", &O::nodes, deck::positive, "nodes of the shaft to report beside the bearings");
  d.add("samples", &O::samples, deck::at_least(8), "samples per revolution, among which extremes are looked for");
  d.add("tolerance", &O::tolerance, deck::between(1e-13, 1e-2),
        "error allowed to a step, in clearances; rounding lets none be smaller than the limit");
  d.add("checkpoint", &O::checkpoint, "write checkpoints to resume from");
  d.check([](const O& o, const deck::Report& r) {
    if (o.acceleration.has_value() == o.duration.has_value())
      r.fail("", "a run-up has either an 'acceleration' or a 'duration'");
  });
}

void RunUp::validate(const system::Machine& machine, const deck::Report& report) const {
  check_unbalance(options.unbalance, machine, report);
  check_nodes("nodes", options.nodes, machine, report);
}

}  // namespace whirl::study
