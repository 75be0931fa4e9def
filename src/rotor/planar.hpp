#pragma once
// A rotor of circular section is the same in both planes and the planes couple only through the gyroscopic moment, so
// everything is built once for one plane, with freedoms 2 (node - 1) + {0: displacement, 1: slope}, then inner freedoms
// of elements, and then doubled.

#include "whirl/core/petsc.hpp"
#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// Matrices of one plane. Each rank owns whole nodes; inner freedoms stand on the last rank. `gyroscopic` is symmetric:
/// its moments act across the planes.
struct Planar {
  core::Matrix mass, gyroscopic, stiffness;
  core::Vector weight;     // consistent nodal forces per unit acceleration along the plane, kg and kg m
  core::Matrix damping{};  // of couplings, which turns with the shaft; empty without
};

/// Assembles the elements and discs of one plane; each rank computes the elements whose left node it owns. Collective.
[[nodiscard]] Planar assemble_planar(MPI_Comm comm, const Options& options);

/// The 2x2 pattern that a planar entry a becomes: [[xx, xy], [yx, yy]] a at rows and columns 2 i + {x, y}.
struct Pattern {
  double xx, xy, yx, yy;
};
inline constexpr Pattern both_planes{1, 0, 0, 1};
inline constexpr Pattern across_planes{0, 1, -1, 0};  // M x'' + Omega G_p y' = 0, M y'' - Omega G_p x' = 0

/// The Kronecker product `planar` x `pattern`; rows and columns are distributed as those of `planar`. Collective.
[[nodiscard]] core::Matrix doubled(Mat planar, const Pattern& pattern);

/// The vector with `scale` times the planar entries in the y places and zero in the x places. Collective.
[[nodiscard]] core::Vector doubled_vertical(Vec planar, double scale);

/// A direct solver for `matrix` (LU; MUMPS on more than one rank), options prefix `rotor_`.
[[nodiscard]] core::LinearSolver direct_solver(Mat matrix);
/// Makes `ksp` such a solver.
void make_direct(KSP ksp);

}  // namespace whirl::rotor
