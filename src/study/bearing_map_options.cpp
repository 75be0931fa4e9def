#include <fmt/core.h>

#include "whirl/study/bearing_map.hpp"

namespace whirl::study {

void describe(deck::Description<BearingMapOptions>& d) {
  using O = BearingMapOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("bearing", &O::bearing, "bearing to look at; the first of the deck if not given");
  d.add("speed", &O::speed, "rad/s", deck::positive, "shaft speed").required();
  d.add("max_eccentricity", &O::max_eccentricity, deck::between(0, 1), "largest eccentricity, in clearances");
  d.add("points", &O::points, deck::at_least(2), "eccentricities, evenly spaced");
  d.add("grid", &O::grid, deck::at_least(3), "points along and across the squeeze velocity in the impedance plot");
}

void BearingMap::validate(const system::Machine& machine, const deck::Report& report) const {
  const auto found =
      options.bearing.empty() ? std::optional<std::size_t>(0) : system::find_bearing(machine, options.bearing);
  if (!found)
    return report.fail("bearing", fmt::format("there is no bearing '{}'{}", options.bearing,
                                              deck::did_you_mean(options.bearing, system::bearing_names(machine))));
  if (machine.bearings.empty() || machine.bearings[*found].film.kind == film::Options::Kind::linear)
    report.fail(options.bearing.empty() ? "" : "bearing", "a linear film has no map");
}

}  // namespace whirl::study
