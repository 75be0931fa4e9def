#include "study/linear/unbalance_response.hpp"

#include "study/cost.hpp"

namespace whirl::study {

void describe(deck::Description<UnbalanceResponseOptions>& d) {
  using O = UnbalanceResponseOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("unbalance", &O::unbalance,
        "names of the unbalances to apply, all at once, and 'discs' for what eccentric and skewed discs do")
      .required();
  d.add("range", &O::range, "rad/s", deck::positive, "range of speeds; results carry its unit").required();
  d.add("points", &O::points, deck::in(2, 1e8), "speeds in the range, evenly spaced with both ends");
  d.add("nodes", &O::nodes, deck::positive, "nodes to report; bearings and unbalance planes if empty");
  d.add(
      "operating_speed", &O::operating_speed, "rad/s", deck::positive,
      "speed at which amplitudes are reported; separation margins are counted from it if there is no operating range");
  d.add("operating", &O::operating, "rad/s", deck::positive,
        "operating speeds, lowest to highest, from which separation margins are counted", "API 617, API 684");
  d.add("refine", &O::refine,
        "add speeds at peaks until their height is settled, and at resonances between the speeds");
}

double UnbalanceResponse::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  const double places = static_cast<double>(machine.bearings.size() + options.nodes.size());
  return memory_of_equilibria(machine) + 1000 * (places + 3) * options.points;
}

void UnbalanceResponse::validate(const system::Machine& machine, const deck::Report& report) const {
  check_unbalance(options.unbalance, machine, report);
  check_nodes("nodes", options.nodes, machine, report);
  if (options.operating && !(options.operating->from <= options.operating->to))
    report.fail("operating", "the lowest operating speed comes first");
}

}  // namespace whirl::study
