#include <fmt/core.h>

#include "study/cost.hpp"
#include "study/equilibrium/equilibrium_branch.hpp"

namespace whirl::study {

void describe(deck::Description<EquilibriumBranchOptions>& d) {
  using O = EquilibriumBranchOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.embed(&O::parameter);
  d.add("speed", &O::speed, "rad/s", deck::positive, "shaft speed, where the parameter is another one");
  d.add("max_points", &O::max_points, deck::positive,
        "points after which the branch ends, without those that `picture_tolerance` adds");
  d.add("picture_tolerance", &O::picture_tolerance, deck::in(0, 1), text_of_picture_tolerance);
  d.add("detect", &O::detect, "bifurcations to locate");
  d.check([](const O& o, const deck::Report& r) {
    for (std::size_t i = 0; i < o.detect.size(); ++i)
      if (o.detect[i] != Event::fold && o.detect[i] != Event::hopf && o.detect[i] != Event::branch_point)
        r.fail(fmt::format("detect.{}", i + 1), "equilibria have fold, hopf and branch_point");
  });
}

double EquilibriumBranch::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  return memory_of_equilibria(machine);
}

void EquilibriumBranch::validate(const system::Machine& machine, const deck::Report& report) const {
  check_parameter(options.parameter, options.speed, machine, report);
}

}  // namespace whirl::study
