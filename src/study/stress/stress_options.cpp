#include "study/cost.hpp"
#include "study/stress/stress.hpp"

namespace whirl::study {

void describe(deck::Description<StressOptions>& d) {
  using O = StressOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("speed", &O::speed, "rad/s", deck::positive, "shaft speed").required().alias("speeds");
  d.add("unbalance", &O::unbalance,
        "names of the unbalances to apply, all at once, and 'discs' for what eccentric and skewed discs do; none: what "
        "stands still alone");
  d.add("endurance", &O::endurance, "Pa", deck::positive,
        "amplitude of alternating stress that the shaft bears for ever, with its notches; gives margins");
  d.add("strength", &O::strength, "Pa", deck::positive, "tensile strength: mean stresses count as well",
        "Goodman 1899");
  d.check([](const O& o, const deck::Report& r) {
    if (o.strength && !o.endurance) r.fail("strength", "Goodman's line ends at 'endurance' as well: give it too");
  });
}

double Stress::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  system::Machine whole = machine;
  whole.rotor.reduction = {};
  return memory_of_equilibria(whole);
}

void Stress::validate(const system::Machine& machine, const deck::Report& report) const {
  if (machine.rotor.type == rotor::Options::Type::rigid)
    return report.fail("", "stresses are those of a shaft; this rotor is rigid");
  if (!options.unbalance.empty()) check_unbalance(options.unbalance, machine, report);
}

}  // namespace whirl::study
