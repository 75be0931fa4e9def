#pragma once
// Half of a rigid rotor on one bearing: the machine of van de Vrande (2001), section 5.3.

#include "whirl/system/rotor_system.hpp"

namespace whirl::test {

/// B = `film`, F0* = 1, R = 5 mm, L = 10 mm, clearance 25 um, water; `eccentricity` of the mass [m] at `phase` [rad].
inline system::Train half_rotor(film::Options film, double eccentricity, double phase = 0) {
  system::Train t;
  t.gravity = 0;
  t.rotor.type = rotor::Options::Type::rigid;
  t.rotor.mass = 0.5;
  t.rotor.load = 0.32;
  system::Support s;
  s.node = 1;
  s.geometry = {film::Geometry::Bore::cylindrical, 0.005, 0.01, 25e-6, 0, 0, 0};
  s.film = std::move(film);
  s.lubricant = {0.001, 1000};
  t.supports = {s};
  t.unbalance = {{1, t.rotor.mass * eccentricity, phase}};
  return t;
}

}  // namespace whirl::test
