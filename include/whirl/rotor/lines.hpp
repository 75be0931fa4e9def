#pragma once
// Torsion and axial motion of a shaft, which of a straight shaft of circular section do not couple with its bending.

#include <span>
#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// Which one freedom a node has: the angle of twist [rad], or the displacement along the shaft [m].
enum class Line { torsion, axial };

/// A chain of linear bar elements with consistent masses, K v = omega^2 M v:
///
///     torsion  G J/L [[1, -1], [-1, 1]],  J the polar moment of the stiffness diameters; I_p of segments and discs
///     axial    E A/L [[1, -1], [-1, 1]];  masses of segments and discs
///
/// A tapered segment has the integral of its stiffness and of its masses along it. In the place of a coupling stands
/// its spring with half of the segment's mass on each end.
struct LineModes {
  std::vector<double> frequencies;          // rad/s, ascending
  std::vector<std::vector<double>> shapes;  // [mode][node], largest entry one
};

/// Order at which the frequencies converge.
inline constexpr double line_order = 2;

/// The lowest `count` modes that vibrate, with the nodes `held` (1-based, possibly none) at rest; fewer if the shaft
/// has fewer. Frequencies converge with h^2 from above. Not collective. Throws core::InputError for bad nodes and for a
/// coupling without the stiffness that is asked for.
[[nodiscard]] LineModes line_modes(const Options& options, Line line, const std::vector<int>& held, int count);

}  // namespace whirl::rotor
