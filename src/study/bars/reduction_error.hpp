#pragma once
// What the reduction of a shaft does to eigenvalues.

#include <complex>
#include <vector>

#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

/// Whether the shaft is reduced, and its films have no own states.
[[nodiscard]] bool has_reduction_errors(const system::RotorSystem& system);

/// For eigenvalues [rad/s] of the reduced machine linearised at the equilibrium x: what they are too large by, the
/// nearest eigenvalues of the whole shaft in the same films subtracted. The equilibrium is that of both, since static
/// condensation is exact. Not a number where that search fails; empty without has_reduction_errors(). The same on every
/// rank. Collective.
[[nodiscard]] std::vector<std::complex<double>> reduction_errors(const system::RotorSystem& system, Vec x,
                                                                 const std::vector<std::complex<double>>& values);

}  // namespace whirl::study
