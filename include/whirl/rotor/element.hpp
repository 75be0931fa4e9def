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

/// Constants of a segment at its temperature. Throws core::DomainError if E(T) is not known there.
/// Source: Gavalas (2022), table 2.1 with A_S, D_AM and J_AD corrected; kappa by Cowper (1966).
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
