#include "whirl/rotor/element.hpp"

#include <numbers>

#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {
namespace {

using std::numbers::pi;

double squared(double a) {
  return a * a;
}
double area(double outer, double inner) {
  return pi / 4 * (squared(outer) - squared(inner));
}
double second_moment(double outer, double inner) {
  return pi / 64 * (squared(squared(outer)) - squared(squared(inner)));
}

// Cowper (1966): circle, and hollow circle with m the ratio of the diameters.
double shear_coefficient(Shear shear, double nu, double m) {
  if (shear == Shear::cowper_solid) return 6 * (1 + nu) / (7 + 6 * nu);
  const double a = squared(1 + m * m);
  return 6 * (1 + nu) * a / ((7 + 6 * nu) * a + (20 + 12 * nu) * m * m);
}

}  // namespace

Beam make_beam(const Segment& s, const Material& material, Shear shear) {
  const bool own = s.outer_stiffness_diameter > 0;
  const double outer = own ? s.outer_stiffness_diameter : s.outer_mass_diameter;
  const double inner = own ? s.inner_stiffness_diameter : s.inner_mass_diameter;
  const double e = modulus(material, s.temperature);

  Beam b;
  b.length = s.length;
  b.bending_stiffness = e * second_moment(outer, inner);
  if (shear != Shear::rigid) {
    const double g = material.shear_modulus > 0 ? material.shear_modulus : e / (2 * (1 + material.poisson));
    const double kappa = shear_coefficient(shear, material.poisson, inner / outer);
    b.shear_parameter = 12 * b.bending_stiffness / (kappa * g * area(outer, inner) * squared(s.length));
  }
  const double added = s.added_mass / s.length;
  b.mass_per_length = material.density * area(s.outer_mass_diameter, s.inner_mass_diameter) + added;
  b.inertia_per_length = material.density * second_moment(s.outer_mass_diameter, s.inner_mass_diameter) +
                         added * (squared(s.added_mass_outer_diameter) + squared(s.added_mass_inner_diameter)) / 16;
  return b;
}

Eigen::Matrix4d stiffness(const Beam& b) {
  const double l = b.length, phi = b.shear_parameter;
  const double k11 = 12, k12 = 6 * l, k22 = (4 + phi) * l * l, k24 = (2 - phi) * l * l;
  Eigen::Matrix4d k;
  k << k11, k12, -k11, k12,   //
      k12, k22, -k12, k24,    //
      -k11, -k12, k11, -k12,  //
      k12, k24, -k12, k22;
  return b.bending_stiffness / (l * l * l * (1 + phi)) * k;
}

Eigen::Matrix4d translational_mass(const Beam& b) {
  const double l = b.length, p = b.shear_parameter;
  const double a1 = 13.0 / 35 + 7 * p / 10 + p * p / 3;
  const double a2 = (11.0 / 210 + 11 * p / 120 + p * p / 24) * l;
  const double a3 = 9.0 / 70 + 3 * p / 10 + p * p / 6;
  const double a4 = -(13.0 / 420 + 3 * p / 40 + p * p / 24) * l;
  const double a5 = (1.0 / 105 + p / 60 + p * p / 120) * l * l;
  const double a6 = -(1.0 / 140 + p / 60 + p * p / 120) * l * l;
  Eigen::Matrix4d m;
  m << a1, a2, a3, a4,   //
      a2, a5, -a4, a6,   //
      a3, -a4, a1, -a2,  //
      a4, a6, -a2, a5;
  return b.mass_per_length * l / squared(1 + p) * m;
}

Eigen::Matrix4d rotary_mass(const Beam& b) {
  const double l = b.length, p = b.shear_parameter;
  const double b1 = 6.0 / 5;
  const double b2 = (1.0 / 10 - p / 2) * l;
  const double b3 = (2.0 / 15 + p / 6 + p * p / 3) * l * l;
  const double b4 = (-1.0 / 30 - p / 6 + p * p / 6) * l * l;
  Eigen::Matrix4d m;
  m << b1, b2, -b1, b2,   //
      b2, b3, -b2, b4,    //
      -b1, -b2, b1, -b2,  //
      b2, b4, -b2, b3;
  return b.inertia_per_length / (l * squared(1 + p)) * m;
}

Eigen::Vector4d weight(const Beam& b) {
  const double l = b.length;
  return b.mass_per_length * l * Eigen::Vector4d(0.5, l / 12, 0.5, -l / 12);
}

}  // namespace whirl::rotor
