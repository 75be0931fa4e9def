#include "whirl/rotor/describe.hpp"

#include <fmt/core.h>

#include <unordered_set>

#include "whirl/rotor/element.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {

using deck::non_negative;
using deck::positive;

std::span<const deck::Name<Options::Type>> names(Options::Type) {
  static constexpr deck::Name<Options::Type> table[] = {
      {Options::Type::shaft, "shaft", "beam elements and discs"},
      {Options::Type::rigid, "rigid", "a mass that moves in x and y without tilt; its only node is 1"}};
  return table;
}

std::span<const deck::Name<Shear>> names(Shear) {
  static constexpr deck::Name<Shear> table[] = {
      {Shear::cowper_solid, "cowper_solid", "6 (1 + nu)/(7 + 6 nu), also for hollow sections"},
      {Shear::cowper_hollow, "cowper_hollow", "Cowper (1966) for the hollow circle"},
      {Shear::rigid, "rigid", "no shear deformation"}};
  return table;
}

std::span<const deck::Name<BeamElement>> names(BeamElement) {
  static constexpr deck::Name<BeamElement> table[] = {
      {BeamElement::rayleigh, "rayleigh", "no shear deformation, whatever 'shear' is; frequencies converge with h^4"},
      {BeamElement::timoshenko, "timoshenko",
       "one shear angle, tied to the curvature as in the static solution (Nelson 1980); exact at rest, frequencies "
       "converge with h^2"},
      {BeamElement::timoshenko_linear, "timoshenko_linear",
       "shear angle and curvature linear and independent: two inner freedoms a plane, frequencies converge with h^4"},
      {BeamElement::timoshenko_hermitian, "timoshenko_hermitian",
       "16 freedoms: displacement and slope cubic and independent, with shear angle and curvature at the ends, which "
       "are "
       "one where neither sections, discs nor bearings let them jump; frequencies converge with h^6"}};
  return table;
}

std::span<const deck::Name<LossFrame>> names(LossFrame) {
  static constexpr deck::Name<LossFrame> table[] = {
      {LossFrame::shaft, "shaft",
       "that of the shaft, as of its material: forward whirl slower than the shaft is driven, synchronous forward "
       "whirl "
       "untouched"},
      {LossFrame::stationary, "stationary", "the stationary one: every whirl is damped"}};
  return table;
}

std::span<const deck::Name<Reduction::Type>> names(Reduction::Type) {
  using enum Reduction::Type;
  static constexpr deck::Name<Reduction::Type> table[] = {
      {none, "none", "every node keeps its four freedoms"},
      {guyan, "guyan", "static condensation onto the translations of the masters"},
      {craig_bampton, "craig_bampton", "masters and the lowest modes of the shaft with its masters held"},
      {craig_bampton_state, "craig_bampton_state",
       "masters, their velocities, and the slowest complex modes of the turning shaft with its masters held: the basis "
       "keeps gyroscopic moments and damping, at one speed"},
      {modal, "modal", "the lowest real modes of the shaft at rest, free or on springs at its masters"}};
  return table;
}

void describe(deck::Description<Segment>& d) {
  d.add("rotor", &Segment::rotor, "name of the rotor that the segment belongs to (HP, GEN, ...)");
  d.add("part", &Segment::part, "name of the portion of the shaft");
  d.add("length", &Segment::length, "m", positive, "length of the element").required();
  d.add("outer_mass_diameter", &Segment::outer_mass_diameter, "m", positive, "outer diameter of the material",
        "004 table 2.1")
      .required()
      .alias("diameter")
      .alias("outer_diameter");
  d.add("inner_mass_diameter", &Segment::inner_mass_diameter, "m", non_negative, "bore of the material")
      .alias("inner_diameter")
      .alias("bore");
  d.add("right_outer_diameter", &Segment::right_outer_diameter, "m", positive,
        "outer diameter at the right end of a tapered segment; absent: as at the left end");
  d.add("right_inner_diameter", &Segment::right_inner_diameter, "m", non_negative,
        "bore at the right end of a tapered segment; absent: as at the left end");
  d.add("outer_stiffness_diameter", &Segment::outer_stiffness_diameter, "m", non_negative,
        "outer diameter of the part that bends; 0: both stiffness diameters are the mass diameters", "004 table 2.1");
  d.add("inner_stiffness_diameter", &Segment::inner_stiffness_diameter, "m", non_negative,
        "bore of the part that bends");
  d.add("added_mass", &Segment::added_mass, "kg", non_negative,
        "blades, windings, rings: mass without stiffness, spread over the length");
  d.add("added_mass_inner_diameter", &Segment::added_mass_inner_diameter, "m", non_negative,
        "inner diameter of the annulus of the added mass");
  d.add("added_mass_outer_diameter", &Segment::added_mass_outer_diameter, "m", non_negative,
        "outer diameter of the annulus of the added mass");
  d.add("temperature", &Segment::temperature, "K", positive, "temperature, for the modulus");
  d.check([](const Segment& s, const deck::Report& r) {
    auto fits = [&](double inner, double outer, const char* key, const char* other) {
      if (inner >= outer) r.fail(key, fmt::format("'{}' must be smaller than '{}'", key, other));
    };
    fits(s.inner_mass_diameter, s.outer_mass_diameter, "inner_mass_diameter", "outer_mass_diameter");
    if (s.outer_stiffness_diameter > 0)
      fits(s.inner_stiffness_diameter, s.outer_stiffness_diameter, "inner_stiffness_diameter",
           "outer_stiffness_diameter");
    if (tapered(s)) {
      const Segment right = section_at(s, 1);
      fits(right.inner_mass_diameter, right.outer_mass_diameter, "right_inner_diameter", "right_outer_diameter");
      if (s.outer_stiffness_diameter > 0)
        r.fail("right_outer_diameter",
               "a tapered segment bends with its mass diameters: stiffness diameters are not taken");
    }
    if (s.added_mass_inner_diameter > s.added_mass_outer_diameter)
      r.fail("added_mass_inner_diameter", "'added_mass_inner_diameter' exceeds 'added_mass_outer_diameter'");
  });
}

void describe(deck::Description<Disc>& d) {
  d.add("node", &Disc::node, positive, "node that carries the disc").required();
  d.add("mass", &Disc::mass, "kg", non_negative, "mass, beside that of the geometry").continuable();
  d.add("polar_inertia", &Disc::polar_inertia, "kg m^2", non_negative,
        "moment of inertia about the shaft axis; of a body at most twice the diametral one");
  d.add("diametral_inertia", &Disc::diametral_inertia, "kg m^2", non_negative,
        "moment of inertia about a diameter through the centre of mass");
  d.add("outer_diameter", &Disc::outer_diameter, "m", non_negative, "outer diameter; 0: no geometry").alias("diameter");
  d.add("inner_diameter", &Disc::inner_diameter, "m", non_negative, "diameter of the bore").alias("bore");
  d.add("thickness", &Disc::thickness, "m", non_negative, "axial thickness");
  d.add("density", &Disc::density, "kg/m^3", non_negative, "density; 0: that of the shaft");
  d.add("offset", &Disc::offset, "m", deck::any, "how far along the shaft the centre of mass lies beyond the node",
        "003 (1.72)")
      .continuable();
  d.add("eccentricity", &Disc::eccentricity, "m", non_negative,
        "distance of the centre of mass from the axis of the shaft; acts where a study names the unbalance 'discs'",
        "003 (1.75)")
      .continuable();
  d.add("eccentricity_phase", &Disc::eccentricity_phase, "rad", deck::any,
        "angle of the centre of mass from +x at shaft angle zero, counter-clockwise");
  d.add("skew", &Disc::skew, "rad", deck::in(0, 0.1),
        "angle between the axis of the disc and that of the shaft; acts as the eccentricity does", "003 (1.75)")
      .continuable();
  d.add("skew_phase", &Disc::skew_phase, "rad", deck::any,
        "angle of the direction from +x in which the axis of the disc leans, at shaft angle zero, counter-clockwise");
  d.add(
      "rotor", &Disc::rotor,
      "name of the rotor that the disc belongs to, for balance grades; that of the segments at its node if not given, "
      "so that it is needed only where two rotors meet");
  d.add("hub", &Disc::hub, positive,
        "nodes at both ends of the hub: the disc tilts as the line through them, the mean slope of the deflection; not "
        "given: as the section of the shaft at its node",
        "003 sec. 2.2.1");
  d.check([](const Disc& x, const deck::Report& r) {
    if (!x.hub.empty() && (x.hub.size() != 2 || x.hub[0] > x.node || x.hub[1] < x.node || x.hub[0] == x.hub[1]))
      r.fail("hub", "'hub' is two nodes, ascending, with that of the disc between them or at one of them");
    if (x.outer_diameter > 0 && x.inner_diameter >= x.outer_diameter)
      r.fail("inner_diameter", "'inner_diameter' must be smaller than 'outer_diameter'");
    if (x.outer_diameter > 0 && x.thickness <= 0)
      r.fail("thickness", "'thickness' must be positive for a disc with a diameter");
    if (x.outer_diameter <= 0 && x.mass <= 0) r.fail("", "a disc needs a mass, or a diameter and a thickness");
  });
}

void describe(deck::Description<Coupling>& d) {
  d.add("segment", &Coupling::segment, positive,
        "segment in whose place it stands: two rigid halves with the mass of its outline, springs half way")
      .required();
  d.add("stiffness", &Coupling::stiffness, "N/m", positive, "of the offset of the axes").required().continuable();
  d.add("tilt_stiffness", &Coupling::tilt_stiffness, "N m/rad", non_negative, "of the angle between the axes")
      .continuable();
  d.add("damping", &Coupling::damping, "N s/m", non_negative, "of the offset of the axes; turns with the shaft");
  d.add("tilt_damping", &Coupling::tilt_damping, "N m s/rad", non_negative,
        "of the angle between the axes; turns with the shaft");
  d.add("torsional_stiffness", &Coupling::torsional_stiffness, "N m/rad", non_negative,
        "of the twist, for torsional modes");
  d.add("axial_stiffness", &Coupling::axial_stiffness, "N/m", non_negative, "along the shaft, for axial modes");
}

void describe(deck::Description<Material>& d) {
  using Point = std::pair<double, double>;
  d.add("density", &Material::density, "kg/m^3", positive, "density of the shaft");
  d.add("poisson", &Material::poisson, deck::Check{.min = 0, .max = 0.5, .max_open = true}, "Poisson's ratio");
  d.table_or_scalar(
       "modulus", &Material::modulus, "modulus",
       [](deck::Description<Point>& row) {
         row.add("temperature", &Point::first, "K", positive, "temperature of the point").required();
         row.add("modulus", &Point::second, "Pa", positive, "Young's modulus there").required();
       },
       "Young's modulus, one value or linear between the points of a table over temperature")
      .required();
  d.add("shear_modulus", &Material::shear_modulus, "Pa", non_negative, "shear modulus; 0: E/(2 (1 + poisson))");
  d.check([](const Material& m, const deck::Report& r) {
    for (std::size_t i = 1; i < m.modulus.size(); ++i)
      if (m.modulus[i].first <= m.modulus[i - 1].first)
        r.fail(fmt::format("modulus.{}", i + 1), "temperatures of the modulus must ascend");
  });
}

void describe(deck::Description<Reduction>& d) {
  using enum Reduction::Type;
  d.add("type", &Reduction::type, "which freedoms of the shaft are kept");
  d.add("masters", &Reduction::masters, positive,
        "nodes whose translations are kept, and whose slopes where a film there tilts")
      .required()
      .only(&Reduction::type, {guyan, craig_bampton, craig_bampton_state, modal});
  d.add("modes", &Reduction::modes, positive,
        "modes per plane: of the shaft with its masters held beside these, or of type 'modal' in all; of "
        "'craig_bampton_state' two pairs of complex modes for each")
      .required()
      .only(&Reduction::type, {craig_bampton, craig_bampton_state, modal});
  d.add("speed", &Reduction::speed, "rad/s", non_negative,
        "speed of the shaft while its complex modes are computed; they are kept at all speeds", "003 sec. 2.4.4")
      .required()
      .only(&Reduction::type, {craig_bampton_state});
  d.add("support", &Reduction::support, "N/m", non_negative,
        "springs at the masters while the modes are computed; 0: modes of the free shaft", "003 sec. 2.3")
      .only(&Reduction::type, {modal});
  d.check([](const Reduction& x, const deck::Report& r) {
    if (x.type == none) return;
    if (x.type == modal && x.modes < static_cast<int>(x.masters.size()))
      r.fail("modes",
             fmt::format("{} masters need as many modes per plane at least, not {}", x.masters.size(), x.modes));
    if (x.masters.size() < 2) r.fail("masters", "'masters' needs at least two nodes");
    std::unordered_set<int> seen;
    for (std::size_t i = 0; i < x.masters.size(); ++i)
      if (!seen.insert(x.masters[i]).second)
        r.fail(fmt::format("masters.{}", i + 1), fmt::format("node {} is a master twice", x.masters[i]));
  });
}

void describe(deck::Description<Options>& d) {
  using enum Options::Type;
  d.add("type", &Options::type, "model of the rotor");
  d.add("mass", &Options::mass, "kg", positive, "mass of the rigid rotor")
      .required()
      .continuable()
      .only(&Options::type, {rigid});
  d.add("load", &Options::load, "N", deck::any, "static force along -y beside the weight", "000 sec. 5.1")
      .continuable()
      .only(&Options::type, {rigid});
  d.table("segments", &Options::segments, "beam elements along the shaft; node k is the left end of segment k")
      .required()
      .only(&Options::type, {shaft});
  d.add("discs", &Options::discs, "rigid discs at nodes").alias("disks").only(&Options::type, {shaft});
  d.add("couplings", &Options::couplings, "flexible couplings in the place of segments").only(&Options::type, {shaft});
  d.add("material", &Options::material, "material of the shaft").required().only(&Options::type, {shaft});
  d.add("shear", &Options::shear, "shear coefficient of the Timoshenko element", "004 errata 5")
      .only(&Options::type, {shaft});
  d.add("element", &Options::element, "beam element", "003 app. A, sec. 2.2").only(&Options::type, {shaft});
  d.add("stiffness_damping", &Options::stiffness_damping, "s", non_negative,
        "damping per stiffness in the stationary frame, C = value K", "004 errata 8")
      .continuable()
      .only(&Options::type, {shaft});
  d.add("internal_damping", &Options::internal_damping, "s", non_negative,
        "viscous damping of the material per stiffness, which turns with the shaft: it damps whirl above the speed and "
        "drives "
        "forward whirl below it",
        "003 (2.29)-(2.35)")
      .continuable()
      .only(&Options::type, {shaft});
  d.add("loss_factor", &Options::loss_factor, deck::in(0, 1),
        "eta of hysteretic damping, K (1 + i eta): of vibration with one frequency alone, so that 'modes', "
        "'unbalance_response' and 'frequency_response' take it and studies in time refuse it",
        "003 (2.36)-(2.38)")
      .only(&Options::type, {shaft});
  d.add("loss_frame", &Options::loss_frame, "frame whose frequency decides the sign of the loss")
      .only(&Options::type, {shaft});
  d.add("reduction", &Options::reduction, "reduction of the shaft's freedoms").only(&Options::type, {shaft});
  d.check([](const Options& o, const deck::Report& r) {
    if (o.type == rigid) return;
    if (n_inner(o.element) > 0 && o.shear == Shear::rigid)
      r.fail("element", "an element with independent shear needs a shear stiffness: 'shear' is rigid");
    if (o.loss_factor > 0 && o.reduction.type == Reduction::Type::craig_bampton_state)
      r.fail("loss_factor",
             "a shaft with a loss factor has no equations of first order in time, which 'craig_bampton_state' reduces");
    const int n_nodes = static_cast<int>(o.segments.size()) + 1;
    auto node = [&](int k, const std::string& path) {
      if (k > n_nodes) r.fail(path, fmt::format("node {} does not exist: the shaft has nodes 1 to {}", k, n_nodes));
    };
    for (std::size_t i = 0; i < o.discs.size(); ++i) {
      node(o.discs[i].node, fmt::format("discs.{}.node", i + 1));
      if (!o.discs[i].hub.empty()) node(o.discs[i].hub.back(), fmt::format("discs.{}.hub", i + 1));
    }
    for (std::size_t i = 0; i < o.couplings.size(); ++i) {
      const std::string path = fmt::format("couplings.{}.segment", i + 1);
      const int k = o.couplings[i].segment;
      if (k >= n_nodes)
        r.fail(path, fmt::format("segment {} does not exist: the shaft has segments 1 to {}", k, n_nodes - 1));
      else if (tapered(o.segments[static_cast<std::size_t>(k - 1)]))
        r.fail(path, fmt::format("segment {} is tapered: a coupling has an outline of constant diameters", k));
      for (std::size_t j = 0; j < i; ++j)
        if (o.couplings[j].segment == k) r.fail(path, fmt::format("segment {} has a coupling already", k));
    }
    if (o.reduction.type != Reduction::Type::none)
      for (std::size_t i = 0; i < o.reduction.masters.size(); ++i)
        node(o.reduction.masters[i], fmt::format("reduction.masters.{}", i + 1));
    // Each inner node has a translation and a slope in a plane, each master its slope.
    const int inner = 2 * n_nodes - static_cast<int>(o.reduction.masters.size());
    const bool fixed_interface =
        o.reduction.type == Reduction::Type::craig_bampton || o.reduction.type == Reduction::Type::craig_bampton_state;
    if (fixed_interface && o.reduction.modes > inner)
      r.fail("reduction.modes",
             fmt::format("the shaft with its masters held has {} modes per plane, not {}", inner, o.reduction.modes));
    const auto& table = o.material.modulus;
    if (table.size() < 2) return;
    for (std::size_t i = 0; i < o.segments.size(); ++i) {
      const double t = o.segments[i].temperature;
      if (t >= table.front().first && t <= table.back().first) continue;
      return r.fail("material.modulus",
                    fmt::format("the modulus is known from {:.6g} K to {:.6g} K, but segment {} is at {:.6g} K",
                                table.front().first, table.back().first, i + 1, t));
    }
  });
}

}  // namespace whirl::rotor
