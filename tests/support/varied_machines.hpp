#pragma once
// Machines that have every option which studies may vary.

#include <numbers>
#include <string>

#include "whirl/system/options.hpp"

namespace whirl::test {

inline constexpr double degrees = std::numbers::pi / 180;

// Shaft of four equal segments, 200 kg.
inline rotor::Options four_segments() {
  rotor::Options o;
  o.segments.assign(4, {"R", "", 0.5, 0.125, 0});
  o.material.modulus = {{293.15, 2e11}};
  o.discs = {{.node = 2, .mass = 20, .polar_inertia = 0.4, .diametral_inertia = 0.2},
             {.node = 4, .mass = 10, .outer_diameter = 0.3, .thickness = 0.02}};
  o.stiffness_damping = 1e-5;
  return o;
}

inline system::Bearing bearing(const std::string& name, int node, const film::Options& film,
                               film::Geometry::Bore bore) {
  system::Bearing b;
  b.name = name;
  b.node = node;
  b.elevation = 2e-5 * node;
  b.film = film;
  b.lubricant = "oil";
  const bool circle = bore == film::Geometry::Bore::cylindrical;
  b.geometry = film::Geometry{bore, 0.0625, 0.05, 1e-4, circle ? 0 : 150 * degrees, 0, 0};
  return b;
}

// A film whose oil warms up, between walls of given temperatures.
inline film::Thd warm_film() {
  film::Thd o;
  o.cells = {12, 4};
  o.feed = 318;
  o.viscosity = thermal::ViscosityOptions{thermal::Vogel{0.02, 323, 900, 170}};
  o.bush = {film::HeatedWall::Type::isothermal, 325};
  o.journal = {film::HeatedWall::Type::isothermal, 330};
  return o;
}

// A spring to a pedestal and one between nodes, which carry load, and a seal that does not: of constant coefficients,
// seen by slopes, and over the speed.
inline std::vector<system::Element> varied_elements() {
  system::Element spring, link, seal;
  spring.name = "spring";
  spring.node = 2;
  spring.to_pedestal = "B1";
  spring.role = system::Role::support;
  spring.stiffness = {2e6, 0, 0, 3e6};
  link.name = "link";
  link.node = 2;
  link.to_node = 5;
  link.damping = {1e3, 0, 0, 2e3};
  link.slopes = system::SlopeTerms{{{{2e4, 0, 0, 0}, {0, 0, 0, 3e4}, {1e4, 0, 0, 0}}},
                                   {{{0, 2e2, 0, 0}, {3e2, 0, 0, 0}, {0, 0, 50, 0}}},
                                   {{{0, 0, 0, 1}, {2, 0, 0, 0}, {0.5, 0, 0, 0}}}};
  seal.name = "seal";
  seal.node = 2;
  seal.role = system::Role::seal;
  seal.stiffness = {5e6, 2e6, 0, 0};
  seal.mass = {0, 0, 0, 12};
  seal.cross_coupling = 1e6;
  seal.table = {{.speed = 100, .k_xx = 1e6, .k_yy = 1e6, .c_xx = 1e3, .c_ab = 20, .m_xx = 5},
                {.speed = 300, .k_xx = 3e6, .k_yy = 2e6, .c_xx = 1e3, .c_ab = 30, .m_xx = 6},
                {.speed = 500, .k_xx = 6e6, .k_yy = 2e6, .c_xx = 2e3, .c_ab = 60, .m_xx = 8}};
  return {spring, link, seal};
}

// Reduced shaft; a pedestal, films of several kinds without states, of which two tilt and one is warm; unbalance by
// amount and by grade.
inline system::Machine reduced_machine() {
  using enum film::Geometry::Bore;
  system::Machine m;
  m.rotor = four_segments();
  m.rotor.reduction = {rotor::Reduction::Type::craig_bampton, {1, 2, 3, 5}, 2};
  m.lubricants["oil"] = {0.02, 870};
  film::Reynolds turbulent;
  turbulent.cells = {24, 6};
  turbulent.cavitation = film::Reynolds::Cavitation::half_sommerfeld;
  turbulent.turbulence = film::Turbulence::constantinescu;
  turbulent.tilt = true;  // in line with the shaft, which all that bends it turns
  m.bearings.push_back(bearing("B1", 1, turbulent, lemon_bore));
  m.bearings[0].geometry->preload = 0.3;
  m.bearings[0].geometry->offset = 2e-5;
  m.bearings[0].pedestal = system::Pedestal{{50, 60}, {4e8, 5e8}, {3e4, 2e4}};
  film::Reynolds fed;
  fed.cells = {24, 6};
  fed.cavitation = film::Reynolds::Cavitation::mass_conserving;
  fed.grooves = {{90 * degrees, 20 * degrees, 1e5}};
  fed.holes = {{250 * degrees, 0, 0.02, 2e5}};
  fed.tilt = true;
  m.bearings.push_back(bearing("B2", 3, fed, cylindrical));
  m.bearings[1].slope = {{1e-4, -2e-4}};
  m.bearings.push_back(bearing("B3", 5, film::Linear{{1e8, 2e6, -3e6, 2e8}, {1e5, 2e3, 4e3, 2e5}}, cylindrical));
  m.bearings[2].geometry.reset();
  m.bearings[2].lubricant = "";
  m.bearings.push_back(bearing("B4", 2, warm_film(), lemon_bore));
  m.bearings[3].geometry->preload = 0.3;
  m.gravity = std::array{4.0, -9.0, 2.0};
  m.loads = {{2, {300, -200}, {{10, -20}}}, {5, {0, 50}, {}}};
  m.elements = varied_elements();
  m.elements.back().static_load = true;  // F is then linear in what it is linear in without films
  m.unbalance.push_back({"two", {}, {}, "", {}, {{2, {}, 1e-3, {}, 0.4}, {4, {}, 2e-3, {}, 0}}});
  m.unbalance.push_back({"grade", system::BalanceGrade{2.5e-3}, 377, "R", {}, {{3, 1.0, {}, {}, 1}}});
  return m;
}

// Whole shaft with films that have states.
inline system::Machine whole_machine() {
  using enum film::Geometry::Bore;
  system::Machine m;
  m.rotor = four_segments();
  m.rotor.internal_damping = 2e-6;
  m.rotor.couplings = {{.segment = 3, .stiffness = 1e8, .tilt_stiffness = 1e6, .damping = 1e3, .tilt_damping = 10}};
  rotor::Disc& bad = m.rotor.discs[0];
  bad.offset = 0.02;
  bad.eccentricity = 1e-5;
  bad.skew = 1e-3;
  m.lubricants["oil"] = {0.02, 870};
  film::Reynolds content;
  content.cells = {16, 4};
  content.cavitation = film::Reynolds::Cavitation::mass_conserving;
  content.states = film::Reynolds::States::dynamic;
  content.edge_fill = 0.8;
  content.bulk_modulus = 1e9;
  m.bearings.push_back(bearing("B1", 1, content, partial_arc));
  film::CompliantFinite liner;
  liner.cells = {16, 6};
  liner.differences = film::Compliant::Differences::central;
  liner.liner = film::Liner{2e-3, 1e9, 0.4};
  liner.liner_damping = 1e-4;
  liner.contact = film::Contact{2e-5, 1e12};
  m.bearings.push_back(bearing("B2", 3, liner, cylindrical));
  m.bearings[1].lubricant = film::Lubricant{0.015, 900};
  film::CompliantShort thick;
  thick.cells = {24, 4};
  thick.differences = film::Compliant::Differences::central;
  thick.compliance = 0.1;
  thick.reference_speed = 300;
  thick.rubber_thickness = 5e-4;
  m.bearings.push_back(bearing("B3", 5, thick, cylindrical));
  m.bearings[2].pedestal = system::Pedestal{{50, 50}, {4e8, 4e8}, {3e4, 3e4}};
  // Without states, behind films that have some and depend on the same oil.
  m.bearings.push_back(bearing("B4", 4, film::Short{}, cylindrical));
  film::Thd following = warm_film();
  following.states = film::States::dynamic;
  following.layers = 2;
  m.bearings.push_back(bearing("B5", 2, following, partial_arc));
  m.bearings[4].lubricant = film::Lubricant{0.02, 880};
  return m;
}

inline system::Machine rigid_machine() {
  system::Machine m;
  m.rotor.type = rotor::Options::Type::rigid;
  m.rotor.mass = 40;
  m.rotor.load = 100;
  m.lubricants["oil"] = {0.02, 870};
  m.bearings.push_back(bearing("B1", 1, film::Short{}, film::Geometry::Bore::cylindrical));
  film::Gas gas;  // fed through pockets, in a bore of three arcs
  gas.states = film::States::condensed;
  gas.cells = {24, 6};
  gas.orifices = {{.count = 6,
                   .diameter = 2e-4,
                   .supply = 6e5,
                   .law = film::OrificeRow::Law::two_restrictors,
                   .pocket = film::Pocket{2e-3, 1e-4}}};
  gas.lobes = film::Lobes{.preload = 0.2};
  m.bearings.push_back(bearing("B2", 1, gas, film::Geometry::Bore::cylindrical));
  m.bearings[1].lubricant = film::Lubricant{1.8e-5, 1.2};
  m.loads = {{1, {20, -30}, {}}};
  m.unbalance.push_back({"one", {}, {}, "", {}, {{1, {}, {}, 2e-5, 0.3}}});
  return m;
}

}  // namespace whirl::test
