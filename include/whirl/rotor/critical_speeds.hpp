#pragma once
// Undamped critical speeds of a shaft on springs.

#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// Whether the shaft whirls with its rotation or against it.
enum class Whirl { forward, backward };

/// The lowest `count` speeds [rad/s], ascending, at which the undamped and unreduced shaft whirls at its own speed on
/// isotropic springs of `stiffness` [N/m] at `nodes` (1-based, at least two): K v = Omega^2 (M -+ G) v with the
/// matrices of one plane. Fewer where inertia leaves fewer: discs whose polar inertia is the larger one lift forward
/// ones to infinity. Dense, 20 n^3 operations for n freedoms of a plane. Not collective; throws core::InputError.
[[nodiscard]] std::vector<double> critical_speeds(const Options& options, const std::vector<int>& nodes,
                                                  double stiffness, Whirl whirl, int count);

}  // namespace whirl::rotor
