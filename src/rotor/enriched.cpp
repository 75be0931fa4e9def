// Elements whose shear angle is free of their curvature.

#include <array>
#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/rotor/element.hpp"

namespace whirl::rotor {
namespace {

// Displacement u, slope s, curvature ds/dz and shear angle du/dz - s that each freedom gives, at one place.
struct Shapes {
  Eigen::RowVectorXd u, s, curvature, shear;
};

Shapes zero_shapes(Eigen::Index n) {
  const Eigen::RowVectorXd zero = Eigen::RowVectorXd::Zero(n);
  return {zero, zero, zero, zero};
}

// Nodes by the static solution, whose energy is then orthogonal to that of the inner freedoms.
Shapes linear_shapes(const Beam& b, double x) {
  const double l = b.length, p = b.shear_parameter, d = 1 + p;
  Shapes n = zero_shapes(6);
  n.u << (2 * x * x * x - 3 * x * x - p * x + d) / d, l * (x * x * x - (2 + p / 2) * x * x + (1 + p / 2) * x) / d,
      (-2 * x * x * x + 3 * x * x + p * x) / d, l * (x * x * x - (1 - p / 2) * x * x - p / 2 * x) / d, l * (x * x - x),
      l * (3 * x * x - 2 * x * x * x - x);
  n.s << 6 * (x * x - x) / (l * d), (3 * x * x - (4 + p) * x + d) / d, -6 * (x * x - x) / (l * d),
      (3 * x * x - (2 - p) * x) / d, 0, 6 * x * (1 - x);
  n.curvature << 6 * (2 * x - 1) / (l * d), (6 * x - 4 - p) / d, -6 * (2 * x - 1) / (l * d), (6 * x - 2 + p) / d, 0,
      6 * (1 - 2 * x);
  n.curvature /= l;
  n.shear << -p / (l * d), -p / (2 * d), p / (l * d), -p / (2 * d), 2 * x - 1, -1;
  return n;
}

// Cubic Hermite polynomials and their derivatives in z, for (value, derivative) at both ends.
struct Hermite {
  std::array<double, 4> value, slope;
};

Hermite hermite(double l, double x) {
  return {{1 - 3 * x * x + 2 * x * x * x, l * (x - 2 * x * x + x * x * x), 3 * x * x - 2 * x * x * x,
           l * (x * x * x - x * x)},
          {6 * (x * x - x) / l, 1 - 4 * x + 3 * x * x, 6 * (x - x * x) / l, 3 * x * x - 2 * x}};
}

// Freedoms (u1, s1, u2, s2, g1, c1, g2, c2): du/dz = s + g and ds/dz = c at the ends.
Shapes hermitian_shapes(const Beam& b, double x) {
  const Hermite h = hermite(b.length, x);
  Shapes n = zero_shapes(8);
  n.u << h.value[0], h.value[1], h.value[2], h.value[3], h.value[1], 0, h.value[3], 0;
  n.s << 0, h.value[0], 0, h.value[2], 0, h.value[1], 0, h.value[3];
  n.curvature << 0, h.slope[0], 0, h.slope[2], 0, h.slope[1], 0, h.slope[3];
  n.shear << h.slope[0], h.slope[1], h.slope[2], h.slope[3], h.slope[1], 0, h.slope[3], 0;
  n.shear -= n.s;
  return n;
}

// Gauss-Legendre on (0, 1), exact to degree 7: products of cubics have degree 6.
struct Gauss {
  double place, weight;
};

std::array<Gauss, 4> gauss() {
  const double a = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2)), b = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2)),
               w = std::sqrt(30.0) / 72;
  return {{{(1 - b) / 2, 0.25 - w}, {(1 - a) / 2, 0.25 + w}, {(1 + a) / 2, 0.25 + w}, {(1 + b) / 2, 0.25 - w}}};
}

}  // namespace

ElementMatrices element_matrices(const Beam& b, Element element) {
  const int inner = n_inner(element);
  if (inner == 0) return {stiffness(b), translational_mass(b), rotary_mass(b), weight(b)};
  core::require(b.shear_parameter > 0, "a shear stiffness");
  const double shear_stiffness = 12 * b.bending_stiffness / (b.shear_parameter * b.length * b.length);
  const Eigen::Index n = 4 + inner;
  ElementMatrices m{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n),
                    Eigen::VectorXd::Zero(n)};
  for (const auto& [place, share] : gauss()) {
    const Shapes at = element == Element::timoshenko_linear ? linear_shapes(b, place) : hermitian_shapes(b, place);
    const double dz = share * b.length;
    m.stiffness += dz * (b.bending_stiffness * at.curvature.transpose() * at.curvature +
                         shear_stiffness * at.shear.transpose() * at.shear);
    m.translational_mass += dz * b.mass_per_length * at.u.transpose() * at.u;
    m.rotary_mass += dz * b.inertia_per_length * at.s.transpose() * at.s;
    m.weight += dz * b.mass_per_length * at.u.transpose();
  }
  return m;
}

}  // namespace whirl::rotor
