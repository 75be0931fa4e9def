#pragma once
// The linear answer of a machine to its unbalance at one speed, as a state.

#include <petscvec.h>

#include <array>
#include <vector>

#include "whirl/solve/newton/frequency_resolvent.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

/// Real and imaginary part of z, x = Re(z exp(i angle)), about the equilibrium x at the `speed` [rad/s] of the system:
/// each whole on every rank [size()]. `solver` is one of this system. Collective; throws core::NotConverged at an
/// undamped resonance.
[[nodiscard]] std::array<std::vector<double>, 2> synchronous_response(system::RotorSystem& system,
                                                                      solve::FrequencyResolvent& solver, Vec x,
                                                                      double speed);

}  // namespace whirl::study
