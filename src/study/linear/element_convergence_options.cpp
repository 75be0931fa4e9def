#include <fmt/core.h>

#include <algorithm>

#include "study/linear/element_convergence.hpp"
#include "whirl/rotor/describe.hpp"

namespace whirl::study {

void describe(deck::Description<ElementConvergenceOptions>& d) {
  using O = ElementConvergenceOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("speed", &O::speed, "rad/s", deck::non_negative, "shaft speed").required().alias("speeds");
  d.add(
      "parts", &O::parts, deck::in(1, 1000),
      "numbers of equal parts into which every segment of the shaft is cut, rising; errors are counted from the last");
  d.add("elements", &O::elements, "kinds of beam element that are compared; shifts are counted from the first");
  d.add("count", &O::count, deck::in(1, 1e4), "modes, those of lowest frequency");
  d.add("condition", &O::condition, "condition numbers of the modes' vectors, of stiffness and of mass",
        "Skarolek (2011) eq. (2.39)");
  d.check([](const O& o, const deck::Report& r) {
    if (o.parts.size() < 2 ||
        std::adjacent_find(o.parts.begin(), o.parts.end(), std::greater_equal<>()) != o.parts.end())
      r.fail("parts", "give two or more numbers of parts that rise");
    if (o.elements.empty()) r.fail("elements", "'elements' is empty");
  });
}

void ElementConvergence::validate(const system::Machine& machine, const deck::Report& report) const {
  if (machine.rotor.type == rotor::Options::Type::rigid) report.fail("", "a rigid rotor has no elements");
  for (std::size_t i = 0; i < options.elements.size(); ++i)
    if (machine.rotor.shear == rotor::Shear::rigid && options.elements[i] != rotor::BeamElement::rayleigh &&
        options.elements[i] != rotor::BeamElement::timoshenko)
      report.fail(fmt::format("elements.{}", i + 1), "a shaft whose sections are rigid in shear has no such element");
  if (machine.rotor.reduction.type != rotor::Reduction::Type::none)
    report.fail("",
                "the shaft is reduced, whose errors would be counted as those of the elements: "
                "set rotor.reduction.type to none");
  if (options.speed.value <= 0) check_carried_at_rest("speed", machine, report);
}

double ElementConvergence::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  const double n = 8.0 * options.parts.back() * static_cast<double>(machine.rotor.segments.size() + 1);
  return 8 * 20 * n * n;
}

}  // namespace whirl::study
