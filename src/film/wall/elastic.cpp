// Kinds of film on an elastic liner: their options, and what others may ask.
#include "whirl/film/contract/elastic.hpp"

#include "film/sheet/refine.hpp"
#include "whirl/film/contract/describe.hpp"

namespace whirl::film {

namespace {
using deck::positive;
}  // namespace

std::span<const deck::Name<Compliant::Quadrature>> names(Compliant::Quadrature) {
  static constexpr deck::Name<Compliant::Quadrature> table[] = {
      {Compliant::Quadrature::sub_cell, "sub_cell", "positive part of the piecewise linear pressure, exactly"},
      {Compliant::Quadrature::simpson, "simpson",
       "Simpson's rule over the positive nodal pressures, as in the source"}};
  return table;
}

std::span<const deck::Name<Compliant::Differences>> names(Compliant::Differences) {
  static constexpr deck::Name<Compliant::Differences> table[] = {
      {Compliant::Differences::central, "central", "central differences of second order"},
      {Compliant::Differences::upwind, "upwind", "backward differences of second order, as in the source"},
      {Compliant::Differences::third_order, "third_order", "third order, biased against the flow (kappa = 1/3)"}};
  return table;
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

void describe(deck::Description<Contact>& d) {
  d.add("roughness", &Contact::roughness, "m", positive, "standard deviation sigma of the heights of both surfaces")
      .required()
      .continuable();
  d.add("pressure", &Contact::pressure, "Pa", positive, "K E' of p = K E' 4.4086e-5 (4 - h/sigma)^6.804")
      .required()
      .continuable();
}

void describe(deck::Description<Compliant>& d) {
  d.add("cells", &Compliant::cells, deck::in(4, 2000),
        "intervals around and along the bearing; of a short or long film around only");
  d.add("states", &Compliant::states,
        "own states; dynamic unless given. Condensed: the deflection of the liner is that of the pressure and does not "
        "change as the journal moves");
  d.add("liner", &Compliant::liner, "elastic layer of the bore");
  d.add("compliance", &Compliant::compliance, "1", positive,
        "B = 6 mu Omega_0 U R^2/(p c^3), instead of a liner: its deflection U under pressure p", "000 eq. 4.23")
      .continuable();
  d.add("reference_speed", &Compliant::reference_speed, "rad/s", deck::non_negative, "Omega_0 of 'compliance'");
  d.add("liner_damping", &Compliant::liner_damping, "s", deck::non_negative,
        "tau of a Kelvin-Voigt liner: p = (elastic pressure) + tau (rate of the deflection)/(deflection per pressure)")
      .continuable();
  d.add("rubber_thickness", &Compliant::rubber_thickness, "m", positive,
        "thickness of a liner that stiffens as bonded rubber does (Lindley 1966); linear if absent", "000 sec. 6.2")
      .continuable();
  d.add("contact", &Compliant::contact, "asperities that carry where the film is thin (Greenwood and Tripp 1971)",
        "000 sec. 6.2");
  d.add("grooves", &Compliant::grooves, "axial grooves at pressure zero; of a long film one at the top if absent",
        "000 sec. 6.2");
  d.add("quadrature", &Compliant::quadrature, "how the force is integrated");
  d.add("differences", &Compliant::differences,
        "differences of the thickness around the bearing; upwind unless given. Others make waves of the mesh that grow "
        "where a film is thin");
  d.check([](const Compliant& o, const deck::Report& r) {
    for (const Groove& g : o.grooves)
      if (g.pressure != 0) r.fail("grooves", "only grooves of films with cavitation mass_conserving have a pressure");
    if (o.states == States::condensed && o.liner_damping > 0)
      r.fail("liner_damping", "only a film with dynamic states knows how fast its liner gives way");
    if (o.liner.has_value() == o.compliance.has_value())
      r.fail("", "a compliant film has either a 'liner' or a 'compliance'");
    if (o.compliance && !(o.reference_speed > 0))
      r.fail("compliance", "'compliance' needs 'reference_speed', the speed Omega_0 that scales it");
    if (o.quadrature == Compliant::Quadrature::simpson && o.cells[0] % 2 != 0)
      r.fail("cells", "Simpson's rule needs an even number of cells");
  });
}

void describe(deck::Description<CompliantShort>& d) {
  d.inherit<Compliant>();
}
void describe(deck::Description<CompliantLong>& d) {
  d.inherit<Compliant>();
}
void describe(deck::Description<CompliantFinite>& d) {
  d.inherit<Compliant>();
  d.check([](const CompliantFinite& o, const deck::Report& r) {
    if (o.quadrature == Compliant::Quadrature::simpson && o.cells[1] % 2 != 0)
      r.fail("cells", "Simpson's rule needs an even number of cells");
  });
}

void refine(Compliant& options, const std::array<double, 2>& factor) {
  const bool even = options.quadrature == Compliant::Quadrature::simpson;
  for (std::size_t d = 0; d < 2; ++d) options.cells[d] = refined(options.cells[d], factor[d], even);
}

namespace {

// Those of a film with a mesh around the bearing alone.
Facts facts_around(const Compliant& options) {
  Facts f;
  f.gives_way = true;
  f.own_states = options.states == States::dynamic;
  f.asperities = options.contact.has_value();
  f.force_by_rates = f.own_states && options.liner_damping > 0;
  f.states = f.own_states ? options.cells[0] : 0;
  f.cells = {options.cells[0], 0};
  f.mesh_order = options.differences == Compliant::Differences::upwind ? 1 : 2;
  f.smoothness =
      options.quadrature == Compliant::Quadrature::simpson
          ? Smoothness{0, "the force has kinks where a nodal pressure changes its sign (quadrature: simpson)"}
          : Smoothness{1, "the tangents have kinks where the edge of the positive pressure passes a node"};
  f.circle_only = {"type", "a film in closed form needs a cylindrical bore"};
  return f;
}

}  // namespace

Facts facts_of(const CompliantShort& options, const Geometry& /*geometry*/) {
  return facts_around(options);
}
Facts facts_of(const CompliantLong& options, const Geometry& /*geometry*/) {
  return facts_around(options);
}
Facts facts_of(const CompliantFinite& options, const Geometry& /*geometry*/) {
  Facts f = facts_around(options);
  f.cells = options.cells;
  f.states *= options.cells[1];
  return f;
}

}  // namespace whirl::film
