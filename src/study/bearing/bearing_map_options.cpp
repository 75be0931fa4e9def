
#include "study/bearing/bearing_map.hpp"
#include "study/bearing/held_film.hpp"
#include "whirl/film/contract/options.hpp"

namespace whirl::study {

void describe(deck::Description<BearingMapOptions>& d) {
  using O = BearingMapOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("bearing", &O::bearing, "bearing to look at; the first of the deck if not given");
  d.add("speed", &O::speed, "rad/s", deck::positive, "shaft speed").required().alias("speeds");
  d.add("max_eccentricity", &O::max_eccentricity, deck::positive,
        "largest eccentricity, in clearances; that of a compliant bearing may exceed 1");
  d.add("points", &O::points, deck::in(2, 1e8), "eccentricities, evenly spaced");
  d.add("grid", &O::grid, deck::in(3, 1e4),
        "eccentricities in the impedance plot, closer together towards the wall; directions have twice as many");
  d.add("frequencies", &O::frequencies, deck::positive,
        "frequencies omega/Omega at which the stiffness and damping of a film with own states are tabulated; the first "
        "one is that of the locus");
  d.add("sommerfeld", &O::sommerfeld, deck::positive,
        "Sommerfeld numbers (loads) at which position, coefficients and the pressure around the bearing are reported");
}

double BearingMap::memory(const system::Machine&, const LayoutOptions& /*layout*/) const {
  const double frequencies = static_cast<double>(options.frequencies.size());
  return 600.0 * (1 + frequencies) * options.points + 130.0 * options.grid * options.grid;
}

void BearingMap::validate(const system::Machine& machine, const deck::Report& report) const {
  const auto found = bearing_to_look_at(machine, options.bearing, report);
  if (!found) return;
  const film::Facts film = film::facts(machine.bearings[*found].film);
  if (film.coefficients) report.fail(options.bearing.empty() ? "" : "bearing", "a linear film has no map");
  if (options.frequencies.empty()) report.fail("frequencies", "the list is empty");
  if (!film.gives_way && !(options.max_eccentricity < 1))
    report.fail("max_eccentricity", "'max_eccentricity' of a rigid bearing must be below 1");
  if (!film.own_states && options.frequencies != std::vector<double>{1})
    report.fail("frequencies", "stiffness and damping of a film without own states do not depend on the frequency");
}

}  // namespace whirl::study
