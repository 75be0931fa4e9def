// Elements by quadrature: those whose shear angle is free of their curvature, and tapered ones.

#include <array>
#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/shaft.hpp"

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

// Cubic u without inner freedoms: those of the nodes alone.
Shapes nodal_shapes(const Beam& b, double x) {
  Shapes n = linear_shapes(b, x);
  for (Eigen::RowVectorXd* of : {&n.u, &n.s, &n.curvature, &n.shear}) of->conservativeResize(4);
  return n;
}

Shapes shapes(const Beam& b, BeamElement element, double x) {
  if (element == BeamElement::timoshenko_linear) return linear_shapes(b, x);
  if (element == BeamElement::timoshenko_hermitian) return hermitian_shapes(b, x);
  return nodal_shapes(b, x);
}

// Gauss-Legendre on (0, 1).
struct Gauss {
  double place, weight;
};

// Exact to degree 7: products of cubics have degree 6.
constexpr std::array<Gauss, 4> along_uniform{{{0.069431844202973713, 0.17392742256872693},
                                              {0.33000947820757187, 0.32607257743127307},
                                              {0.66999052179242813, 0.32607257743127307},
                                              {0.93056815579702629, 0.17392742256872693}}};
// Exact to degree 11: times the fourth power of a diameter.
constexpr std::array<Gauss, 6> along_tapered{{{0.033765242898423989, 0.085662246189585178},
                                              {0.16939530676686776, 0.18038078652406930},
                                              {0.38069040695840156, 0.23395696728634552},
                                              {0.61930959304159844, 0.23395696728634552},
                                              {0.83060469323313224, 0.18038078652406930},
                                              {0.96623475710157601, 0.085662246189585178}}};

// Adds what a piece dz of the element with this section has.
void add_piece(ElementMatrices& m, const Beam& b, const Shapes& at, double dz) {
  m.stiffness += dz * b.bending_stiffness * at.curvature.transpose() * at.curvature;
  if (b.shear_parameter > 0)
    m.stiffness +=
        dz * 12 * b.bending_stiffness / (b.shear_parameter * b.length * b.length) * at.shear.transpose() * at.shear;
  m.translational_mass += dz * b.mass_per_length * at.u.transpose() * at.u;
  m.rotary_mass += dz * b.inertia_per_length * at.s.transpose() * at.s;
  m.weight += dz * b.mass_per_length * at.u.transpose();
}

ElementMatrices empty_matrices(BeamElement element) {
  const Eigen::Index n = 4 + n_inner(element);
  return {Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n),
          Eigen::VectorXd::Zero(n)};
}

}  // namespace

ElementMatrices element_matrices(const Beam& b, BeamElement element) {
  if (n_inner(element) == 0) return {stiffness(b), translational_mass(b), rotary_mass(b), weight(b)};
  core::require(b.shear_parameter > 0, "a shear stiffness");
  ElementMatrices m = empty_matrices(element);
  for (const auto& [place, share] : along_uniform) add_piece(m, b, shapes(b, element, place), share * b.length);
  return m;
}

ElementMatrices element_matrices(const Segment& s, const Material& material, Shear shear, BeamElement element) {
  if (!tapered(s)) return element_matrices(make_beam(s, material, shear), element);
  core::require(n_inner(element) == 0 || shear != Shear::rigid, "a shear stiffness");
  const Beam half_way = make_beam(section_at(s, 0.5), material, shear);
  ElementMatrices m = empty_matrices(element);
  for (const auto& [place, share] : along_tapered)
    add_piece(m, make_beam(section_at(s, place), material, shear), shapes(half_way, element, place), share * s.length);
  return m;
}

}  // namespace whirl::rotor
