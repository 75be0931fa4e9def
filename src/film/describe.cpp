#include "whirl/film/describe.hpp"

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

std::span<const deck::Name<Options::Kind>> names(Options::Kind) {
  static constexpr deck::Name<Options::Kind> table[] = {
      {Options::Kind::reynolds, "reynolds", "two-dimensional Reynolds equation, pressure condensed"},
      {Options::Kind::linear, "linear", "constant stiffness and damping"},
      {Options::Kind::short_bearing, "short", "closed form without flow around the bearing (L/D below 1/2)"},
      {Options::Kind::long_bearing, "long", "closed form without side flow, periodic pressure, half of it positive"},
      {Options::Kind::long_inlet, "long_inlet", "closed form without side flow, pressure zero at the top (90 deg)"},
      {Options::Kind::finite_approximate, "finite_approximate",
       "harmonic sum of the short and the long film, along and across the eccentricity"},
      {Options::Kind::compliant_short, "compliant_short", "short film on an elastic liner, thickness as state"},
      {Options::Kind::compliant_long, "compliant_long",
       "film without side flow on an elastic liner, thickness as state, pressure zero at the top (90 deg)"},
      {Options::Kind::compliant_finite, "compliant_finite",
       "two-dimensional film on an elastic liner, thickness on a mesh as states"}};
  return table;
}

std::span<const deck::Name<Options::Cavitation>> names(Options::Cavitation) {
  static constexpr deck::Name<Options::Cavitation> table[] = {
      {Options::Cavitation::half_sommerfeld, "half_sommerfeld", "negative pressure is cut off after the solution"},
      {Options::Cavitation::reynolds, "reynolds", "complementarity: pressure and its slope vanish at the rupture"},
      {Options::Cavitation::mass_conserving, "mass_conserving",
       "Jakobsson, Floberg and Olsson: pressure where the gap is full, oil carried along where it is not; it enters at "
       "edges of pads, grooves and inlets. Loads, stiffness and flows are exact; damping is that of a cavity that "
       "neither fills nor empties, unless 'states' are dynamic"},
      {Options::Cavitation::none, "none", "negative pressure stays"}};
  return table;
}

std::span<const deck::Name<Options::States>> names(Options::States) {
  static constexpr deck::Name<Options::States> table[] = {
      {Options::States::condensed, "condensed", "none: what the cavity holds does not change as the journal moves"},
      {Options::States::dynamic, "dynamic",
       "what the gap holds beyond or short of its volume, at every node: the cavity fills and empties in time, and the "
       "oil is compressible"}};
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

std::span<const deck::Name<Options::Quadrature>> names(Options::Quadrature) {
  static constexpr deck::Name<Options::Quadrature> table[] = {
      {Options::Quadrature::sub_cell, "sub_cell", "positive part of the piecewise linear pressure, exactly"},
      {Options::Quadrature::simpson, "simpson", "Simpson's rule over the positive nodal pressures, as in the source"}};
  return table;
}

std::span<const deck::Name<Options::Differences>> names(Options::Differences) {
  static constexpr deck::Name<Options::Differences> table[] = {
      {Options::Differences::central, "central", "central differences of second order"},
      {Options::Differences::upwind, "upwind", "backward differences of second order, as in the source"},
      {Options::Differences::third_order, "third_order", "third order, biased against the flow (kappa = 1/3)"}};
  return table;
}

std::span<const deck::Name<Options::Turbulence>> names(Options::Turbulence) {
  static constexpr deck::Name<Options::Turbulence> table[] = {
      {Options::Turbulence::laminar, "laminar", "flow coefficients 12"},
      {Options::Turbulence::constantinescu, "constantinescu",
       "mixing length; coefficients grow with the local Reynolds number"}};
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

void describe(deck::Description<Liner>& d) {
  d.add("thickness", &Liner::thickness, "m", positive, "thickness of the layer, small against the length")
      .required()
      .continuable();
  d.add("modulus", &Liner::modulus, "Pa", positive, "Young's modulus").required().continuable();
  d.add("poisson", &Liner::poisson, deck::Check{.min = 0, .max = 0.5, .max_open = true},
        "Poisson's ratio, not close to 1/2", "000 sec. 4.2")
      .required();
}

void describe(deck::Description<Groove>& d) {
  d.add("angle", &Groove::angle, "rad", deck::any, "middle of the groove, from +x counter-clockwise").required();
  d.add("width", &Groove::width, "rad", deck::Check{.min = 0, .max = 2 * pi, .max_open = true},
        "angle that it covers; its edges are moved to the nearest nodes");
  d.add("pressure", &Groove::pressure, "Pa", deck::non_negative,
        "of the lubricant in it; other than zero where cavitation is mass_conserving")
      .continuable();
}

void describe(deck::Description<Contact>& d) {
  d.add("roughness", &Contact::roughness, "m", positive, "standard deviation sigma of the heights of both surfaces")
      .required()
      .continuable();
  d.add("pressure", &Contact::pressure, "Pa", positive, "K E' of p = K E' 4.4086e-5 (4 - h/sigma)^6.804")
      .required()
      .continuable();
}

void describe(deck::Description<Inlet>& d) {
  d.add("type", &Inlet::type, "where pressure zero is held");
  d.add("angle", &Inlet::angle, "rad", deck::any, "of the line, from +x counter-clockwise; the top if not given")
      .only(&Inlet::type, {Inlet::Type::line});
}

void describe(deck::Description<Options>& d) {
  using enum Options::Kind;
  d.add("type", &Options::kind, "model of the film");
  d.add("cavitation", &Options::cavitation,
        "what happens where the pressure would be negative; half_sommerfeld, the cheapest, unless given")
      .only(&Options::kind, {reynolds});
  d.add("edge_fill", &Options::edge_fill, "1", deck::Check{.min = 0, .max = 1, .min_open = true},
        "part of the gap that is full of oil where it enters a pad, of mass_conserving films")
      .continuable()
      .only(&Options::kind, {reynolds});
  d.add("states", &Options::states, "own states of a mass_conserving film; condensed, the cheapest, unless given")
      .only(&Options::kind, {reynolds});
  d.add(
       "bulk_modulus", &Options::bulk_modulus, "Pa", positive,
       "of the oil where the gap is full, of a film with dynamic states: it stores h (1 + p/bulk_modulus). Mineral oil "
       "without air, 1.5 GPa, unless given; equilibria do not depend on it")
      .continuable()
      .only(&Options::kind, {reynolds});
  d.add("turbulence", &Options::turbulence,
        "flow coefficients of the film; laminar unless given, however large the Reynolds number", "004 errata 15")
      .only(&Options::kind, {reynolds});
  d.add("inlet", &Options::inlet, "where the film of a cylindrical bore without grooves starts",
        "Raimondi and Boyd 1958")
      .only(&Options::kind, {reynolds});
  d.add("cells", &Options::cells, deck::in(4, 2000),
        "intervals around and along each pad; of a short or long compliant film around only")
      .only(&Options::kind, {reynolds, compliant_short, compliant_long, compliant_finite});
  d.add("tilt", &Options::tilt, "follow the slope of the journal (bearings of a machine do not)")
      .only(&Options::kind, {reynolds});
  d.add("stiffness", &Options::stiffness, "N/m", deck::any, "coefficients xx, xy, yx, yy of force = -K d - C d'")
      .isotropic()
      .continuable()
      .only(&Options::kind, {linear});
  d.add("damping", &Options::damping, "N s/m", deck::any, "coefficients xx, xy, yx, yy of force = -K d - C d'")
      .isotropic()
      .continuable()
      .only(&Options::kind, {linear});
  d.add("liner", &Options::liner, "elastic layer of the bore")
      .only(&Options::kind, {compliant_short, compliant_long, compliant_finite});
  d.add("compliance", &Options::compliance, "1", positive,
        "B = 6 mu Omega_0 U R^2/(p c^3), instead of a liner: its deflection U under pressure p", "000 eq. 4.23")
      .continuable()
      .only(&Options::kind, {compliant_short, compliant_long, compliant_finite});
  d.add("reference_speed", &Options::reference_speed, "rad/s", deck::non_negative, "Omega_0 of 'compliance'")
      .only(&Options::kind, {compliant_short, compliant_long, compliant_finite});
  d.add("liner_damping", &Options::liner_damping, "s", deck::non_negative,
        "tau of a Kelvin-Voigt liner: p = (elastic pressure) + tau (rate of the deflection)/(deflection per pressure)")
      .continuable()
      .only(&Options::kind, {compliant_short, compliant_long, compliant_finite});
  d.add("rubber_thickness", &Options::rubber_thickness, "m", positive,
        "thickness of a liner that stiffens as bonded rubber does (Lindley 1966); linear if absent", "000 sec. 6.2")
      .continuable()
      .only(&Options::kind, {compliant_short, compliant_long, compliant_finite});
  d.add("contact", &Options::contact, "asperities that carry where the film is thin (Greenwood and Tripp 1971)",
        "000 sec. 6.2")
      .only(&Options::kind, {compliant_short, compliant_long, compliant_finite});
  d.add("grooves", &Options::grooves, "axial grooves at pressure zero; of a long film one at the top if absent",
        "000 sec. 6.2")
      .only(&Options::kind, {reynolds, compliant_short, compliant_long, compliant_finite});
  d.add("quadrature", &Options::quadrature, "how the force is integrated")
      .only(&Options::kind, {compliant_short, compliant_long, compliant_finite});
  d.add("differences", &Options::differences, "differences of the thickness around the bearing")
      .only(&Options::kind, {compliant_short, compliant_long, compliant_finite});
  d.check([](const Options& o, const deck::Report& r) {
    if (o.kind == reynolds && o.inlet.type != Inlet::Type::free && !o.grooves.empty())
      r.fail("inlet", "a film starts at its 'grooves' or at an 'inlet', not at both");
    const bool conserves = o.kind == reynolds && o.cavitation == Options::Cavitation::mass_conserving;
    if (!conserves && o.edge_fill != 1)
      r.fail("edge_fill", "only a film with cavitation mass_conserving knows how full the gap is");
    const bool dynamic = o.states == Options::States::dynamic;
    if (!conserves && dynamic) r.fail("states", "only a film with cavitation mass_conserving has states of its own");
    if (dynamic && o.inlet.type == Inlet::Type::maximum_gap)
      r.fail("inlet",
             "an inlet at the maximum gap turns with the journal: a film with dynamic states cannot follow it");
    if (!dynamic && o.bulk_modulus != Options{}.bulk_modulus)
      r.fail("bulk_modulus", "only a film with dynamic states is compressible");
    for (const Groove& g : o.grooves)
      if (!conserves && g.pressure != 0)
        r.fail("grooves", "only grooves of films with cavitation mass_conserving have a pressure");
  });
  d.check([](const Options& o, const deck::Report& r) {
    if (o.kind != compliant_short && o.kind != compliant_long && o.kind != compliant_finite) return;
    if (o.liner.has_value() == o.compliance.has_value())
      r.fail("", "a compliant film has either a 'liner' or a 'compliance'");
    if (o.compliance && !(o.reference_speed > 0))
      r.fail("compliance", "'compliance' needs 'reference_speed', the speed Omega_0 that scales it");
    const bool odd = o.cells[0] % 2 != 0 || (o.kind == compliant_finite && o.cells[1] % 2 != 0);
    if (o.quadrature == Options::Quadrature::simpson && odd)
      r.fail("cells", "Simpson's rule needs an even number of cells");
  });
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
