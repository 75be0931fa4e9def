#pragma once
// A small machine whose journals stand askew in their bearings.

#include <array>
#include <numbers>
#include <string>

#include "support/at_rest.hpp"

namespace whirl::test {

inline film::Reynolds pads(bool tilt, std::array<int, 2> cells = {30, 10}) {
  film::Reynolds o;
  o.cavitation = film::Reynolds::Cavitation::half_sommerfeld;
  o.tilt = tilt;
  o.cells = cells;
  return o;
}

inline system::Support support(const std::string& name, int node, film::Geometry::Bore bore,
                               const film::Options& film) {
  system::Support s;
  s.name = name;
  s.node = node;
  s.geometry = {bore, 0.05, 0.08, 1e-4, 120 * std::numbers::pi / 180, 0, 0};
  if (bore == film::Geometry::Bore::cylindrical) s.geometry.arc = 0;
  s.film = film;
  s.lubricant = {0.02, 860};
  return s;
}

// A slender shaft with an overhung disc, so that its journals stand askew: arcs at nodes 1 and 5, the first on a
// pedestal.
inline system::Train overhung(bool tilt, std::array<int, 2> cells = {30, 10}) {
  system::Train t;
  rotor::Segment s;
  s.length = 0.2;
  s.outer_mass_diameter = 0.06;
  t.rotor.segments.assign(6, s);
  t.rotor.material.modulus = {{293.15, 2.1e11}};
  t.rotor.stiffness_damping = 1e-5;
  rotor::Disc disc;
  disc.mass = 40;
  disc.polar_inertia = 0.5;
  disc.diametral_inertia = 0.3;
  disc.node = 7;
  t.rotor.discs = {disc};
  disc.node = 3;
  t.rotor.discs.push_back(disc);
  using enum film::Geometry::Bore;
  t.supports = {support("one", 1, partial_arc, pads(tilt, cells)), support("two", 5, partial_arc, pads(tilt, cells))};
  t.supports[0].has_pedestal = true;
  t.supports[0].mass = {20, 25};
  t.supports[0].stiffness = {2e8, 3e8};
  t.supports[0].damping = {1e4, 2e4};
  t.supports[0].elevation = 3e-5;
  t.unbalance = {{7, 4e-4, 0.3}, {3, 2e-4, 1}};
  return t;
}

// The same with the second film's content among the states.
inline system::Train overhung_with_states() {
  system::Train t = overhung(true, {12, 6});
  film::Reynolds content = pads(true, {12, 6});
  content.cavitation = film::Reynolds::Cavitation::mass_conserving;
  content.states = film::States::dynamic;
  t.supports[1].film = content;
  return t;
}

}  // namespace whirl::test
