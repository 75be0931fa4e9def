#pragma once
// Static deflection on rigid supports, and the elevations that give wanted moments and loads.

#include <mpi.h>

#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// A rigid support: the journal at `node` (1-based) sits at height `elevation` (m, positive up).
struct RigidSupport {
  int node = 0;
  double elevation = 0;
};

/// The shaft at rest under gravity, the same on all ranks.
struct RigidStatic {
  std::vector<double> reactions;   // N per support, positive up: the load the journal puts on it
  std::vector<double> deflection;  // m per node, positive up
  std::vector<double> slope;       // dy/dz per node
  std::vector<double> moment;      // N m per node, sagging positive: M = E I d(slope)/dz
};

/// Wanted: zero bending moment at nodes and given loads on supports. As many conditions as unknown elevations.
struct AlignmentRule {
  std::vector<int> adjustable;         // supports whose elevation is sought, 1-based positions in the list of supports
  std::vector<int> zero_moment_nodes;  // 1-based nodes
  std::vector<int> loaded;             // supports with a given load, 1-based positions
  std::vector<double> loads;           // N, one per `loaded`
};

/// Deflection, reactions and moments for given supports (at least two) and acceleration of gravity (m/s^2, along -y).
/// Collective; throws core::InputError for supports that do not hold the shaft.
[[nodiscard]] RigidStatic rigid_static(MPI_Comm comm, const Options& options, const std::vector<RigidSupport>& supports,
                                       double gravity);

/// Elevations of all supports (m) that satisfy `rule`; those not adjustable keep their value. The response is linear in
/// the elevations, so influence coefficients give the exact answer. Collective; throws core::InputError if the
/// conditions do not determine the elevations. Source: Gavalas (2022), sec. 2.1 (zero coupling moments). Cost: one
/// factorisation.
[[nodiscard]] std::vector<double> align(MPI_Comm comm, const Options& options,
                                        const std::vector<RigidSupport>& supports, const AlignmentRule& rule,
                                        double gravity);

}  // namespace whirl::rotor
