#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "study/bearing/held_film.hpp"
#include "study/bearing/thd_at_speed.hpp"
#include "study/bearing/thd_study.hpp"
#include "whirl/thermal/describe.hpp"

namespace whirl::study {

std::span<const deck::Name<ThdOptions::Cavitation>> names(ThdOptions::Cavitation) {
  using enum ThdOptions::Cavitation;
  static constexpr deck::Name<ThdOptions::Cavitation> table[] = {
      {none, "none", "the film holds together; what a gas film is"},
      {half_sommerfeld, "half_sommerfeld", "as none, but pressure below the ambient's does not act on the journal"},
      {reynolds, "reynolds", "no pressure below the ambient's, zero slope where the film ruptures"},
      {mass_conserving, "mass_conserving",
       "the cavity keeps its oil: it is partly filled until the film is full again"}};
  return table;
}

void describe(deck::Description<ThdOptions>& d) {
  using O = ThdOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("bearing", &O::bearing, "bearing to look at; the first of the deck if not given");
  d.add("speeds", &O::speeds, "rad/s", deck::non_negative,
        "shaft speeds, one after the other; fields are written of the last")
      .required()
      .alias("speed");
  describe_place(d);
  d.add("cells", &O::cells, deck::in(2, 1e5), "intervals around and along the film, layers across it");
  d.add("cavitation", &O::cavitation, "what an oil film does where it would be under tension");
  d.add("turbulence", &O::turbulence, "flow resistance, shear and mixing across of a turbulent film");
  d.add("second_order", &O::second_order,
        "convection of heat by limited differences of second order; false: upwind, of first order");
  d.add("fluid", &O::fluid, "what fills the film, with its properties").required();
  d.add("ambient", &O::ambient, "what lies beyond the ends of the film");
  d.add("orifices", &O::orifices, "rings of orifices that feed a gas film");
  d.add("grooves", &O::grooves, "axial grooves that feed an oil film");
  d.add("bush", &O::bush, "wall of the film on the side of the bearing");
  d.add("journal", &O::journal, "wall of the film on the side of the shaft");
  d.add("tolerance", &O::tolerance, deck::between(0, 1e-2),
        "change of temperatures in an iteration, relative to the ambient's, below which it ends");
  d.add(
      "most_iterations", &O::most_iterations, deck::in(1, 10000),
      "iterations between flow and heat after which it gives up unless they still converge: unless the second half of "
      "them has halved the change of the temperatures; at most 20 times as many");
  d.add("meshes", &O::meshes, deck::in(1, 10),
        "meshes of the film that the error bars stand on, that of 'cells' and coarser ones, each with half of the "
        "cells of the one before in every direction; 1: no bars");
  d.add(
      "temperatures", &O::temperatures, "K", deck::positive,
      "temperatures of a table of the properties of the fluid and of the clearance, both solids as warm as the fluid");
  d.check(check_place<O>);
}

double ThdStudy::memory(const system::Machine&, const LayoutOptions& /*layout*/) const {
  const auto& [n, m, l] = options.cells;
  return 900.0 * n * m * l;  // measured: 730 to 860 from 1e6 cells on (docs/speed.md)
}

void ThdStudy::validate(const system::Machine& machine, const deck::Report& report) const {
  using Fluid = thermal::FluidOptions;
  using Wall = thermal::WallOptions;
  const auto found = bearing_to_look_at(machine, options.bearing, report);
  if (!found) return;
  const system::Bearing& bearing = machine.bearings[*found];
  if (!bearing.geometry) return report.fail(options.bearing.empty() ? "" : "bearing", "the bearing has no geometry");
  const film::Geometry& g = *bearing.geometry;
  const bool gas = options.fluid.type == Fluid::Type::gas;
  if (g.type != film::Geometry::Bore::cylindrical)
    report.fail(options.bearing.empty() ? "" : "bearing", "a film with heat needs a cylindrical bore");
  if (options.speeds.empty()) report.fail("speeds", "the list is empty");
  if (!gas && !options.load.values.empty() &&
      std::ranges::any_of(options.speeds, [](const deck::Quantity& speed) { return speed.value == 0; }))
    report.fail("speeds", "the film of a liquid at rest carries no load");
  if (gas && !options.grooves.empty()) report.fail("grooves", "grooves feed a liquid: give a gas 'orifices'");
  if (!gas && !options.orifices.empty()) report.fail("orifices", "orifices feed a gas: give a liquid 'grooves'");
  if (gas && options.cavitation != ThdOptions::Cavitation::none)
    report.fail("cavitation", "a gas does not cavitate: leave 'cavitation' out");
  if (options.cavitation == ThdOptions::Cavitation::mass_conserving &&
      std::ranges::any_of(options.speeds, [](const deck::Quantity& speed) { return speed.value == 0; }))
    report.fail("speeds", "a mass-conserving film needs a turning journal: leave the speed 0 out");
  if (const auto both = orifices_at_one_node(options, g.length))
    report.fail(
        fmt::format("orifices.{}", *both + 1),
        fmt::format("two orifices lie at one node of a mesh of {} x {} 'cells': give it more cells around or along "
                    "the film",
                    options.cells[0], options.cells[1]));
  for (const thermal::OrificeRing& ring : options.orifices) {
    if (std::abs(ring.z) >= g.length / 2 * (1 - 1.0 / options.cells[1]))
      report.fail("orifices", "an orifice lies beyond the ends of the film, or within half a cell of one");
    if (ring.inlet != options.orifices.front().inlet)
      report.fail("orifices", "gas enters from all rings with the temperature of one 'inlet': give them the same");
    if (ring.pressure <= options.ambient.pressure)
      report.fail("orifices", "the supply has no pressure above that of the ambient");
    if (ring.inlet == thermal::OrificeRing::Inlet::bush && options.bush.type == Wall::Type::adiabatic)
      report.fail("orifices", "an adiabatic bush has no temperature that the gas could enter with");
  }
  for (const auto& [which, wall] : {std::pair{"bush", &options.bush}, {"journal", &options.journal}})
    if (wall->growth && wall->expansion <= 0) report.fail(which, "'growth' needs the 'expansion' of the solid");
  if (options.bush.type == Wall::Type::solid && options.bush.radius <= g.radius + g.clearance)
    report.fail("bush", "the outer 'radius' of the bush must lie beyond the film");
  if (options.journal.type == Wall::Type::solid) {
    if (options.journal.radius >= g.radius) report.fail("journal", "the bore's 'radius' must lie within the journal");
    const double length = options.journal.shaft_length > 0 ? options.journal.shaft_length : g.length;
    if (options.journal.shaft_before + g.length > length * (1 + 1e-12))
      report.fail("journal", "'shaft_before' and the bearing reach beyond 'shaft_length'");
  }
}

}  // namespace whirl::study
