#include <fmt/core.h>

#include "study/bearing/gas_bearing.hpp"
#include "study/bearing/held_film.hpp"
#include "whirl/film/contract/gas.hpp"
#include "whirl/film/contract/options.hpp"

namespace whirl::study {

void describe(deck::Description<GasMapOptions>& d) {
  using O = GasMapOptions;
  d.add("clearances", &O::clearances, "m", deck::positive, "clearances of the map").required();
  d.add("diameters", &O::diameters, "m", deck::positive, "diameters of all orifices").required();
  d.add("eccentricity", &O::eccentricity, deck::Check{.min = 0, .max = 1, .max_open = true},
        "distance of the journal from the bearing centre, in clearances");
}

void describe(deck::Description<GasBearingOptions>& d) {
  using O = GasBearingOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("bearing", &O::bearing, "bearing to look at; the first of the deck if not given");
  d.add("speeds", &O::speeds, "rad/s", deck::non_negative, "shaft speeds; each gets a curve").required().alias("speed");
  d.add("eccentricities", &O::eccentricities, deck::Check{.min = 0, .max = 1, .max_open = true},
        "distances of the journal from the bearing centre, in clearances; fields are those of the last");
  d.add("direction", &O::direction, "rad", deck::any, "of the journal from the centre, from +x counter-clockwise");
  d.add("load", &O::load, "N", deck::any,
        "equilibria under this load: one number, positive down, or [x, y]; where there is none, the most that the film "
        "carries is told");
  d.add("meshes", &O::meshes, deck::in(0, 6),
        "table of so many meshes at the first speed and the last eccentricity, that of the deck and coarser ones with "
        "half of its cells in both directions, beside the same with the source in the node, which never converges; 0: "
        "no table");
  d.add("map", &O::map, "load and flow over clearance and diameter of the orifices, at the first speed");
  d.check([](const O& o, const deck::Report& r) {
    if (o.load.values.empty()) return;
    if (o.load.values.size() > 2) return r.fail("load", "'load' must be one number, positive down, or [x, y]");
    if (o.load.values.size() == 1 && o.load.values[0] == 0) r.fail("load", "'load' must not be zero");
  });
}

double GasBearing::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  double states = 0;
  for (const system::Bearing& b : machine.bearings)
    if (const auto* gas = film::find<film::Gas>(b.film)) states = std::max(states, 1.0 * gas->cells[0] * gas->cells[1]);
  return 5000.0 * states;
}

void GasBearing::validate(const system::Machine& machine, const deck::Report& report) const {
  const auto found = film_to_look_at(machine, options.bearing, report);
  if (options.speeds.empty()) report.fail("speeds", "the list is empty");
  if (options.eccentricities.empty()) report.fail("eccentricities", "the list is empty");
  if (!found) return;
  const auto* gas = film::find<film::Gas>(machine.bearings[*found].film);
  if (!gas) return report.fail(options.bearing.empty() ? "" : "bearing", "this study is about films of gas");
  if (options.map && gas->orifices.empty())
    report.fail("map", "a bearing without orifices has no diameters to choose among");
  if (options.map && (options.map->clearances.empty() || options.map->diameters.empty()))
    report.fail("map", "a map needs clearances and diameters");
  const int least = 1 << std::max(options.meshes - 1, 0);
  if (options.meshes > 1 && (gas->cells[0] / least < 4 || gas->cells[1] / least < 2))
    return report.fail(
        "meshes",
        "the coarsest of these meshes has less than 4 x 2 cells: give the film more cells or ask for fewer meshes");
  if (options.meshes <= 1 || !machine.bearings[*found].geometry) return;
  film::Gas coarsest = *gas;
  for (int& n : coarsest.cells) n /= least;
  const film::Misplaced orifice = film::facts_of(coarsest, *machine.bearings[*found].geometry).misplaced;
  if (!orifice.option.empty())
    report.fail("meshes", fmt::format("the coarsest of these meshes is too coarse: {}", orifice.reason));
}

}  // namespace whirl::study
