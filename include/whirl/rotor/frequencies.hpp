#pragma once
// Natural frequencies of the undamped shaft at standstill.

#include <mpi.h>

#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// The lowest `count` bending frequencies (rad/s, ascending) of the unreduced shaft in one plane, K v = omega^2 M v,
/// with the displacement held at the nodes `pinned` (1-based, possibly none). Motions that strain nothing are left out:
/// those of a rigid body, and about couplings without tilt stiffness. Fewer are returned if the shaft has fewer.
/// Collective; throws core::InputError for bad nodes, core::NotConverged.
[[nodiscard]] std::vector<double> natural_frequencies(MPI_Comm comm, const Options& options,
                                                      const std::vector<int>& pinned, int count);

}  // namespace whirl::rotor
