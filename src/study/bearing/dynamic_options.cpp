#include "study/bearing/held_film.hpp"
#include "whirl/film/options.hpp"
#include "whirl/study/bearing/dynamic_coefficients.hpp"

namespace whirl::study {

void describe(deck::Description<DynamicCoefficientsOptions>& d) {
  using O = DynamicCoefficientsOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("bearing", &O::bearing, "bearing to look at; the first of the deck if not given");
  d.add("speeds", &O::speeds, "rad/s", deck::positive, "shaft speeds, one after the other").required();
  d.add("eccentricity", &O::eccentricity, deck::Check{.min = 0, .max = 1, .max_open = true},
        "distance of the journal from the bearing centre, in clearances");
  d.add("attitude", &O::attitude, "rad", deck::any, "direction of the journal from there, from +x counter-clockwise");
  d.add("load", &O::load, "N", deck::any,
        "on the journal, instead of its place: one number, positive down, or [x, y]; the journal is where the force of "
        "the film balances it");
  d.add("frequencies", &O::frequencies, deck::positive,
        "frequencies of the motion over that of the shaft; a film without own states has the same coefficients at all");
  d.add("tilt", &O::tilt,
        "coefficients of the slopes of the journal and their moments too: 4 x 4 of each kind, whatever the film of the "
        "deck follows");
  d.check([](const O& o, const deck::Report& r) { check_place_or_load(o, r); });
}

double DynamicCoefficients::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  // A sparse LU of one film, real and complex.
  double states = 0;
  for (const system::Bearing& b : machine.bearings) states = std::max(states, 1.0 * film::facts(b.film).states);
  return 5000.0 * states;
}

void DynamicCoefficients::validate(const system::Machine& machine, const deck::Report& report) const {
  const auto found = film_to_look_at(machine, options.bearing, report);
  if (options.speeds.empty()) report.fail("speeds", "the list is empty");
  if (options.frequencies.empty()) report.fail("frequencies", "the list is empty");
  if (!found) return;
  if (options.tilt && !film::tilting(machine.bearings[*found].film))
    report.fail("tilt", "a film of this kind knows no slope of its journal");
  const film::Facts film = film::facts(machine.bearings[*found].film);
  if (!film.own_states && options.frequencies.size() > 1)
    report.fail("frequencies",
                "stiffness and damping of a film without own states do not depend on the frequency: one is enough; a "
                "film of gas follows it with 'states: dynamic'");
}

}  // namespace whirl::study
