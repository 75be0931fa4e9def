#pragma once
// A uniform shaft between two plain bearings.

#include "whirl/system/train.hpp"

namespace whirl::test {

/// Eight states a node, segments + 1 nodes.
inline system::Train uniform_shaft(int segments) {
  system::Train t;
  rotor::Segment piece;
  piece.length = 2.0 / segments;
  piece.outer_mass_diameter = 0.1;
  t.rotor.segments.assign(static_cast<std::size_t>(segments), piece);
  t.rotor.material.modulus = {{293.15, 2.1e11}};
  t.rotor.stiffness_damping = 1e-5;
  for (const int node : {1, segments + 1}) {
    system::Support s;
    s.node = node;
    s.geometry = {film::Geometry::Bore::cylindrical, 0.05, 0.05, 1e-4, 0, 0, 0};
    film::Reynolds film;
    film.cells = {24, 6};
    film.cavitation = film::Reynolds::Cavitation::half_sommerfeld;
    s.film = film;
    s.lubricant = {0.02, 860};
    t.supports.push_back(s);
  }
  t.unbalance = {{segments / 2 + 1, 1e-4, 0}};
  return t;
}

}  // namespace whirl::test
