#pragma once
// Small shafts with known answers, and their whirl frequencies from the dense quadratic eigenproblem.

#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::test {

/// A uniform solid shaft of equal elements.
inline rotor::Options uniform_shaft(double length, double diameter, int elements, double modulus = 2.1e11,
                                    double density = 7850, double bore = 0) {
  rotor::Options o;
  o.material.density = density;
  o.material.modulus = {{293.15, modulus}};
  rotor::Segment s;
  s.length = length / elements;
  s.outer_mass_diameter = diameter;
  s.inner_mass_diameter = bore;
  o.segments.assign(static_cast<std::size_t>(elements), s);
  return o;
}

/// A shaft with steps, an added mass, separate stiffness diameters, a temperature gradient and a disc: nothing in it is
/// symmetric along z.
inline rotor::Options stepped_shaft() {
  rotor::Options o = uniform_shaft(1.2, 0.06, 12);
  o.material.modulus = {{273.15, 2.1e11}, {773.15, 1.7e11}};
  for (std::size_t i = 0; i < o.segments.size(); ++i) {
    rotor::Segment& s = o.segments[i];
    s.length *= 0.7 + 0.05 * static_cast<double>(i);
    s.outer_mass_diameter += i > 4 && i < 9 ? 0.03 : 0.0;
    s.outer_stiffness_diameter = s.outer_mass_diameter - (i == 5 ? 0.015 : 0.0);
    s.inner_mass_diameter = s.inner_stiffness_diameter = i == 7 ? 0.02 : 0.0;
    s.added_mass = i == 3 ? 4.0 : 0.0;
    s.added_mass_inner_diameter = 0.06;
    s.added_mass_outer_diameter = 0.15;
    s.temperature = 300 + 20 * static_cast<double>(i);
  }
  rotor::Disc d;
  d.node = 11;
  d.outer_diameter = 0.25;
  d.inner_diameter = 0.06;
  d.thickness = 0.03;
  o.discs.push_back(d);
  o.stiffness_damping = 2e-5;
  return o;
}

/// A spring and dashpot, equal in x and y, at a node.
struct IsotropicBearing {
  int node;
  double stiffness;
  double damping = 0;
};

struct Whirl {
  double frequency;  // rad/s, positive forward (x -> y), negative backward
  double growth;     // 1/s
};

/// Whirl modes by ascending modulus of the frequency, from M q'' + (C + Omega G) q' + (K + Omega N) q = 0. An isotropic
/// rotor moves in circles: with w = x + i y, M_p w'' + (C_p - i Omega G_p) w' + (K_p - i Omega N_p) w = 0, so each
/// complex root has one sense of whirl.
[[nodiscard]] std::vector<Whirl> whirl_modes(const rotor::Options& options,
                                             const std::vector<IsotropicBearing>& bearings, double speed);

}  // namespace whirl::test
