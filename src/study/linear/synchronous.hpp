#pragma once
// The linear answer of a machine to its unbalance at one speed, as a state.

#include <petscvec.h>

#include <array>
#include <complex>
#include <vector>

#include "whirl/solve/newton/frequency_resolvent.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

/// Real and imaginary part of z in x = Re(z exp(i angle)), each whole on every rank [size()].
using HarmonicState = std::array<std::vector<double>, 2>;
/// The answer to harmonic forces, this rank's rows of them, at the frequency that `solver`, one of this system, has
/// factorised. Collective; throws core::NotConverged at an undamped resonance.
[[nodiscard]] HarmonicState harmonic_response(system::RotorSystem& system, solve::FrequencyResolvent& solver,
                                              const std::vector<std::complex<double>>& force);

/// The answer to unbalance about the equilibrium x at the `speed` [rad/s] of the system.
/// Likewise.
[[nodiscard]] HarmonicState synchronous_response(system::RotorSystem& system, solve::FrequencyResolvent& solver, Vec x,
                                                 double speed);

}  // namespace whirl::study
