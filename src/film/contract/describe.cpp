#include "whirl/film/contract/describe.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace whirl::film {
namespace {

using deck::positive;
using std::numbers::pi;

// Smallest thickness of the lower lobe for a centred journal, h = c_p + (offset/2) cos(theta) + (c_p - c_b) sin(theta)
// over the pad's arc about 270 deg; the upper lobe is its mirror image.
double least_thickness(const Geometry& g) {
  const double pad = g.clearance / (1 - g.preload);
  const double a = g.offset / 2, b = pad - g.clearance;
  const auto h = [&](double theta) { return pad + a * std::cos(theta) + b * std::sin(theta); };
  const double lowest = std::atan2(-b, -a), from_middle = std::remainder(lowest - 1.5 * pi, 2 * pi);
  double least = std::min(h(1.5 * pi - g.arc / 2), h(1.5 * pi + g.arc / 2));
  if (std::abs(from_middle) < g.arc / 2) least = std::min(least, h(lowest));
  return least;
}

}  // namespace

std::span<const deck::Name<Geometry::Bore>> names(Geometry::Bore) {
  static constexpr deck::Name<Geometry::Bore> table[] = {
      {Geometry::Bore::partial_arc, "partial_arc", "one pad centred at 270 deg"},
      {Geometry::Bore::lemon_bore, "lemon_bore",
       "two pads centred at 90 and 270 deg, moved towards each other by the preload"},
      {Geometry::Bore::cylindrical, "cylindrical", "a full circle without edges"}};
  return table;
}

std::span<const deck::Name<Inlet::Type>> names(Inlet::Type) {
  static constexpr deck::Name<Inlet::Type> table[] = {
      {Inlet::Type::free, "free", "wherever cavitation lets the film reform"},
      {Inlet::Type::maximum_gap, "maximum_gap",
       "where the film is thickest, turning with the journal: what the tables of Raimondi and Boyd assume"},
      {Inlet::Type::line, "line", "along a line fixed in the bearing, at 'angle'"}};
  return table;
}

std::span<const deck::Name<States>> names(States) {
  static constexpr deck::Name<States> table[] = {
      {States::condensed, "condensed",
       "none: what the cavity holds, or the deflection of the liner, is at every moment that of the journal's motion "
       "at "
       "that moment, and does not change in time. Loads, stiffness and flows are exact, damping is not"},
      {States::dynamic, "dynamic",
       "at every node: what the gap holds beyond or short of its volume, so that the cavity fills and empties in time "
       "and "
       "the oil is compressible; or the thickness over the liner"}};
  return table;
}

void describe(deck::Description<Geometry>& d) {
  using enum Geometry::Bore;
  d.add("type", &Geometry::type, "shape of the bore");
  d.add("radius", &Geometry::radius, "m", positive, "radius of the journal").required().alias("diameter", 2);
  d.add("length", &Geometry::length, "m", positive, "axial length of the pads").required();
  d.add("clearance", &Geometry::clearance, "m", positive,
        "radial clearance of the assembled bearing, the film thickness at the middle of a pad for a centred journal",
        "004 table 2.2")
      .required()
      .continuable();
  d.add("arc", &Geometry::arc, "rad", deck::Check{.min = 0, .max = 2 * pi, .min_open = true},
        "angle that each pad covers, centred at 270 deg (and 90 deg)")
      .required()
      .only(&Geometry::type, {partial_arc, lemon_bore});
  d.add("preload", &Geometry::preload, deck::Check{.min = 0, .max = 1, .max_open = true},
        "1 - clearance / pad clearance", "004 table 2.2")
      .continuable()
      .only(&Geometry::type, {lemon_bore});
  d.add("offset", &Geometry::offset, "m", deck::any,
        "horizontal distance between the lobe centres, the lower to the right", "004 errata 18")
      .continuable()
      .only(&Geometry::type, {lemon_bore});
  d.check([](const Geometry& g, const deck::Report& r) {
    if (!(g.clearance < 0.1 * g.radius))
      r.fail("clearance", "'clearance' must be below a tenth of 'radius': the equations are those of a thin film");
    if (g.type == lemon_bore && g.arc > pi) r.fail("arc", "'arc' must be at most 180 deg where type is lemon_bore");
    if (g.type == lemon_bore && least_thickness(g) <= 0)
      r.fail("offset", "'offset' closes the film of the centred journal: it leaves no thickness at a pad's edge");
  });
}

void describe(deck::Description<Groove>& d) {
  d.add("angle", &Groove::angle, "rad", deck::any, "middle of the groove, from +x counter-clockwise").required();
  d.add("width", &Groove::width, "rad", deck::Check{.min = 0, .max = 2 * pi, .max_open = true},
        "angle that it covers; its edges are moved to the nearest nodes");
  d.add("pressure", &Groove::pressure, "Pa", deck::non_negative,
        "of the lubricant in it; other than zero where cavitation is mass_conserving")
      .continuable();
}

void describe(deck::Description<Hole>& d) {
  d.add("angle", &Hole::angle, "rad", deck::any, "middle of the hole, from +x counter-clockwise").required();
  d.add("z", &Hole::z, "m", deck::any, "its place along the shaft, from the mid-plane of the bearing");
  d.add("diameter", &Hole::diameter, "m", positive,
        "diameter; nodes within the rim hold the pressure, and faces that the rim cuts are shortened to it",
        "Gibou et al. 2002")
      .required();
  d.add("pressure", &Hole::pressure, "Pa", deck::non_negative,
        "of the lubricant in it; other than zero where cavitation is mass_conserving")
      .continuable();
}

void describe(deck::Description<Inlet>& d) {
  d.add("type", &Inlet::type, "where pressure zero is held");
  d.add("angle", &Inlet::angle, "rad", deck::any, "of the line, from +x counter-clockwise; the top if not given")
      .only(&Inlet::type, {Inlet::Type::line});
}

void describe(deck::Description<Options>& d) {
  d.kinds("type", &Options::kind, "model of the film");
}

void describe(deck::Description<Lubricant>& d) {
  d.add("viscosity", &Lubricant::viscosity, "Pa s", positive, "dynamic viscosity at the temperature of the film")
      .required()
      .continuable();
  d.add("density", &Lubricant::density, "kg/m^3", positive, "density, for the Reynolds number of a turbulent film")
      .required()
      .continuable();
}

}  // namespace whirl::film
