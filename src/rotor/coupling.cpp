#include "whirl/rotor/element.hpp"

namespace whirl::rotor {
namespace {

ElementMatrices coupling_matrices(const Coupling& c, const Beam& outline) {
  const double l = outline.length, half = l / 2;
  const Eigen::Vector4d offset(-1, -half, 1, -half), angle(0, -1, 0, 1);
  const auto springs = [&](double on_offset, double on_angle) {
    return Eigen::MatrixXd(on_offset * offset * offset.transpose() + on_angle * angle * angle.transpose());
  };
  // A rigid half on its end: integrals of 1, z and z^2 along it, z from the end.
  const double one = half, first = half * half / 2, second = half * half * half / 3;
  Eigen::Matrix4d mass = Eigen::Matrix4d::Zero(), rotary = Eigen::Matrix4d::Zero();
  mass.topLeftCorner<2, 2>() << one, first, first, second;
  mass.bottomRightCorner<2, 2>() << one, -first, -first, second;
  rotary(1, 1) = rotary(3, 3) = one;
  ElementMatrices m{springs(c.stiffness, c.tilt_stiffness), outline.mass_per_length * mass,
                    outline.inertia_per_length * rotary,
                    outline.mass_per_length * Eigen::Vector4d(one, first, one, -first)};
  if (c.damping > 0 || c.tilt_damping > 0) m.damping = springs(c.damping, c.tilt_damping);
  return m;
}

}  // namespace

const Coupling* coupling_at(const Options& o, std::size_t segment) {
  for (const Coupling& c : o.couplings)
    if (c.segment == static_cast<int>(segment) + 1) return &c;
  return nullptr;
}

ElementMatrices element_matrices(const Options& o, std::size_t segment) {
  const Segment& s = o.segments[segment];
  if (const Coupling* c = coupling_at(o, segment)) return coupling_matrices(*c, make_beam(s, o.material, Shear::rigid));
  return element_matrices(s, o.material, shear_of(o), o.element);
}

}  // namespace whirl::rotor
