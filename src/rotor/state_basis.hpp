#pragma once
// Craig-Bampton's basis for general damping: complex modes of the first-order equations with the masters held.

#include <Eigen/Core>

#include "planar.hpp"
#include "whirl/rotor/rotor.hpp"

namespace whirl::rotor {

/// R and L of one rank, in columns: two for each coordinate of a master (its displacement, its velocity), then the
/// modes. Rows are full coordinates, once for displacements and once for velocities.
struct StateBasis {
  Eigen::MatrixXd displacement, velocity;            // q = R_q u, v = R_v u
  Eigen::MatrixXd left_displacement, left_velocity;  // L_q of the rows M (q' - v) = 0, L_v of the rows of forces
  Eigen::VectorXd offset;                            // as Matrices::offset
  ReductionQuality quality;                          // moduli of eigenvalues with the masters held
};

/// The matrices of u that R and L make of the whole ones, on one rank.
struct StateProjection {
  Eigen::MatrixXd rates, at_rest, turning;
  Eigen::VectorXd gravity, across;  // along -y, along x
};

/// With y = (v, q), N = diag(M, M) and P = [[C + Omega G, K + Omega N_i], [-M, 0]] at Omega = `reduction.speed`:
///
///     R = [[T, 0], [0, T]] of the masters and [V_v; V_q] of the modes,  (s N_ss + P_ss) V = 0
///     L = the same T, and left vectors W with W^T N_ss V = I
///
/// with T = [I; -K_ss^-1 K_sm]. Complex pairs stand as real and imaginary parts. A circular shaft is the mirror image
/// of itself turning the other way, P^T = J P J with J = diag(1, -1) in (x, y), so that a left vector is the mirror
/// image of the right one. The rows of the masters' velocities are divided by the mass T^T M T and those of a pair
/// exchanged, which changes no equation: no diagonal entry of dF/dx is then zero. Dense, of the size of the shaft: 4 n
/// freedoms of a plane squared. Not collective: `planar` stands on this rank. Throws core::InputError where a pair
/// would be cut in two, core::NotConverged. Skarolek (2011), sec. 2.4.4, with L_IB = R_IB.
[[nodiscard]] StateBasis state_basis(const Planar& planar, const Options& options);

[[nodiscard]] StateProjection project(const Planar& planar, const Options& options, const StateBasis& basis);

}  // namespace whirl::rotor
