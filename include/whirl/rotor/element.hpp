#pragma once
// The Timoshenko beam element in one plane: freedoms (u1, s1, u2, s2) with s the slope of the section.

#include <Eigen/Core>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// Constants of one beam element.
struct Beam {
  double length = 0;              // m
  double bending_stiffness = 0;   // E I_S, N m^2
  double shear_parameter = 0;     // Phi = 12 E I_S / (kappa G A_S L^2)
  double mass_per_length = 0;     // rho A_M + M_AM/L, kg/m
  double inertia_per_length = 0;  // diametral j_d = rho I_M + (M_AM/L)(D_AMO^2 + D_AMI^2)/16, kg m; polar 2 j_d
};

/// The matrices of an element, freedoms (u1, s1, u2, s2, inner freedoms); n = 4 + n_inner(element).
///
/// Inner freedoms are zero in rigid motions. timoshenko_linear: a, b with the shear angle a (2 xi - 1) - b and the
/// slope 6 b xi (1 - xi), both at rest at the nodes. timoshenko_hermitian: shear angle [-] and curvature ds/dz [1/m] at
/// the left end, then at the right one.
struct ElementMatrices {
  Eigen::MatrixXd stiffness;  // n x n
  Eigen::MatrixXd translational_mass, rotary_mass;
  Eigen::VectorXd weight;     // n, of a unit acceleration along the plane
  Eigen::MatrixXd damping{};  // n x n, turns with the shaft; empty of a beam
};

/// Inner freedoms of an element per plane.
[[nodiscard]] constexpr int n_inner(BeamElement element) {
  return element == BeamElement::timoshenko_linear ? 2 : element == BeamElement::timoshenko_hermitian ? 4 : 0;
}

/// Shear that an element has: none of the Rayleigh beam.
[[nodiscard]] constexpr Shear shear_of(const Options& options) {
  return options.element == BeamElement::rayleigh ? Shear::rigid : options.shear;
}

/// Matrices of an element. Those without inner freedoms in closed form (below); those with inner freedoms by Gauss
/// quadrature, which is exact here. They need a shear parameter that is not zero.
[[nodiscard]] ElementMatrices element_matrices(const Beam& beam, BeamElement element);

/// The same of a segment, which may be tapered: then by Gauss quadrature along it with the shapes of the element with
/// the section half way, which keeps the order of the frequencies but is not exact at rest. Throws as make_beam does.
[[nodiscard]] ElementMatrices element_matrices(const Segment& segment, const Material& material, Shear shear,
                                               BeamElement element);

/// The same of a segment of a shaft, counted from 0: of its beam, or of the coupling in its place, which has n = 4.
/// With the halves as rigid arms the offset of the axes half way is u2 - u1 - L (s1 + s2)/2, their angle s2 - s1.
[[nodiscard]] ElementMatrices element_matrices(const Options& options, std::size_t segment);

/// The coupling in the place of a segment, counted from 0; null where there is a beam.
[[nodiscard]] const Coupling* coupling_at(const Options& options, std::size_t segment);

/// Constants of a segment at its temperature, of its left end if it is tapered. Throws core::DomainError if E(T) is not
/// known there. Source: Gavalas (2022), table 2.1 with A_S, D_AM and J_AD corrected; kappa by Cowper (1966).
[[nodiscard]] Beam make_beam(const Segment& segment, const Material& material, Shear shear);

/// K = E I/(L^3 (1+Phi)) [[12, 6L, -12, 6L], ...]; Nelson (1980).
[[nodiscard]] Eigen::Matrix4d stiffness(const Beam& beam);

/// Consistent mass of translation; Nelson & McVaugh (1976), Nelson (1980).
[[nodiscard]] Eigen::Matrix4d translational_mass(const Beam& beam);

/// Consistent mass of rotation (diametral); the planar gyroscopic matrix is twice this one.
[[nodiscard]] Eigen::Matrix4d rotary_mass(const Beam& beam);

/// Consistent nodal forces of a unit acceleration along the plane, m L [1/2, L/12, 1/2, -L/12], in kg and kg m.
[[nodiscard]] Eigen::Vector4d weight(const Beam& beam);

}  // namespace whirl::rotor
