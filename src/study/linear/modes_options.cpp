#include "study/linear/modes.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "study/columns.hpp"
#include "study/cost.hpp"
#include "study/evenly.hpp"

namespace whirl::study {

std::span<const deck::Name<ModesOptions::Supports>> names(ModesOptions::Supports) {
  using enum ModesOptions::Supports;
  static constexpr deck::Name<ModesOptions::Supports> table[] = {
      {films, "films", "linearised films and pedestals"},
      {pinned, "pinned", "journals held, slopes free; undamped, not reduced, at rest"},
      {free, "free", "no bearings; likewise"}};
  return table;
}

std::span<const deck::Name<ModesOptions::Motion>> names(ModesOptions::Motion) {
  using enum ModesOptions::Motion;
  static constexpr deck::Name<ModesOptions::Motion> table[] = {
      {bending, "bending", "across the axis"},
      {torsion, "torsion", "about the axis, uncoupled from bending, without bearings: see 'held'"},
      {axial, "axial", "along the axis, likewise"}};
  return table;
}

namespace {

// Without films the shaft is undamped and at rest: what asks about speeds or damping has no effect.
void refuse_what_films_take(const ModesOptions& o, const deck::Report& r) {
  const ModesOptions preset;
  const bool line = o.motion != ModesOptions::Motion::bending;
  if (o.range || !o.speeds.empty())
    r.fail(o.range ? "range" : "speeds", line ? "torsion and axial motion do not depend on the speed: leave it out"
                                              : "without films the shaft is taken at rest: leave the speed out");
  const auto refuse = [&](bool given, const char* key) {
    if (given)
      r.fail(key, fmt::format("'{}' has no effect on undamped modes {}: leave it out", key,
                              line ? "of torsion and axial motion" : "without films"));
  };
  refuse(line && o.supports != preset.supports, "supports");
  refuse(!o.range && o.points != preset.points, "points");
  refuse(o.max_frequency.has_value(), "max_frequency");
  refuse(o.operating.has_value(), "operating");
  refuse(o.condition, "condition");
  refuse(!o.shapes_at.empty(), "shapes_at");
}

}  // namespace

void describe(deck::Description<ModesOptions>& d) {
  d.add("name", &ModesOptions::name, "name in the results; the kind if not given");
  d.add("supports", &ModesOptions::supports, "what holds the journals");
  d.add("motion", &ModesOptions::motion, "which motion of the shaft", "003 (1.61)-(1.62)");
  d.add("held", &ModesOptions::held, deck::positive,
        "nodes that do not turn (torsion) or do not move along the shaft (axial); none if empty")
      .only(&ModesOptions::motion, {ModesOptions::Motion::torsion, ModesOptions::Motion::axial});
  d.add("range", &ModesOptions::range, "rad/s", deck::non_negative, "range of speeds; results carry its unit");
  d.add("points", &ModesOptions::points, deck::in(2, 1e8), "speeds in the range, evenly spaced with both ends");
  d.add("speeds", &ModesOptions::speeds, "rad/s", deck::non_negative,
        "single speeds instead of a range; critical speeds are searched over a range only")
      .alias("speed");
  d.add("count", &ModesOptions::count, deck::in(1, 1e5),
        "modes at each speed, those of lowest frequency with a damping ratio below 0.9; modes that grow come on top");
  d.add("max_frequency", &ModesOptions::max_frequency, std::string(deck::frequency), deck::positive,
        "whirl frequency up to which modes are reported");
  d.add("operating", &ModesOptions::operating, "rad/s", deck::positive,
        "operating speeds, lowest to highest, from which separation margins of critical speeds are counted",
        "API 617, API 684");
  d.add("condition", &ModesOptions::condition,
        "condition number of every eigenvalue, by right and left vectors, and whether multiple ones have as many "
        "vectors; of large machines it takes a second search");
  d.add("shapes_at", &ModesOptions::shapes_at, "rad/s", deck::positive,
        "speeds at which mode shapes are kept and drawn; the last of the speeds if not given");
  d.check([](const ModesOptions& o, const deck::Report& r) {
    if (o.range && !o.speeds.empty()) r.fail("speeds", "give either 'range' or 'speeds', not both");
    if (o.operating && !(o.operating->from <= o.operating->to))
      r.fail("operating", "the lowest operating speed comes first");
    if (o.motion != ModesOptions::Motion::bending || o.supports != ModesOptions::Supports::films)
      return refuse_what_films_take(o, r);
    if (!o.range && o.speeds.empty()) r.fail("", "'range' is missing (of speeds), or a list 'speeds'");
  });
}

std::vector<double> ModesOptions::all_speeds() const {
  return range ? evenly(range->from, range->to, points) : column(speeds, &deck::Quantity::value);
}

std::vector<double> ModesOptions::all_shape_speeds() const {
  return shapes_at.empty() ? std::vector{all_speeds().back()} : column(shapes_at, &deck::Quantity::value);
}

std::string ModesOptions::unit() const {
  return range ? range->unit : speeds.empty() ? "rad/s" : speeds.front().unit;
}

void Modes::validate_line(const system::Machine& machine, const deck::Report& report) const {
  if (machine.rotor.type == rotor::Options::Type::rigid)
    return report.fail("motion", "a rigid rotor has neither torsion nor axial motion");
  check_nodes("held", options.held, machine, report);
  const bool torsion = options.motion == ModesOptions::Motion::torsion;
  for (const rotor::Coupling& c : machine.rotor.couplings)
    if ((torsion ? c.torsional_stiffness : c.axial_stiffness) <= 0)
      report.fail("motion", fmt::format("the coupling of segment {} has no '{}'", c.segment,
                                        torsion ? "torsional_stiffness" : "axial_stiffness"));
}

double Modes::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  const double speeds = options.range ? options.points : static_cast<double>(options.speeds.size());
  return memory_of_equilibria(machine) + 1000 * speeds * std::min<double>(options.count, n_states(machine));
}

void Modes::validate(const system::Machine& machine, const deck::Report& report) const {
  if (options.motion != ModesOptions::Motion::bending) return validate_line(machine, report);
  if (options.supports != ModesOptions::Supports::films) {
    if (machine.rotor.type == rotor::Options::Type::rigid)
      report.fail("supports", "a rigid rotor has no modes but those in its films");
    return;
  }
  bool at_rest = options.range && std::min(options.range->from, options.range->to) <= 0;
  for (const deck::Quantity& s : options.speeds) at_rest = at_rest || s.value <= 0;
  if (at_rest) check_carried_at_rest(options.range ? "range" : "speeds", machine, report);
}

}  // namespace whirl::study
