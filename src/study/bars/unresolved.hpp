#pragma once
// Vibrations of the elements of a shaft that its mesh does not resolve.

#include <complex>

#include "whirl/rotor/options.hpp"

namespace whirl::study {

/// Lowest angular frequency [rad/s] at which half a wave fits into one element of the shaft: omega = (pi/L)^2 (E
/// I/m')^(1/2), the first bending frequency of a pinned beam of the element's length L. Infinite without beams.
/// Source: Rao (2011), Mechanical Vibrations, sec. 8.5 (lateral vibration of beams).
[[nodiscard]] double half_wave_limit(const rotor::Options& shaft);

/// Lowest cut-off of the second spectrum of the shaft's beams [rad/s]: omega = (kappa G A/j_d)^(1/2). Above it
/// cross-sections shear against one another with hardly any motion of the axis, and beam theory ends. Infinite without
/// beams. Source: Stephen (2006), J. Sound Vib. 292, 372-389.
[[nodiscard]] double shear_cut_off(const rotor::Options& shaft);

/// Up to where the elements are beams of the shaft: the lower one of both.
[[nodiscard]] double resolved_to(const rotor::Options& shaft);

/// Whether an eigenvalue is a vibration of the elements: above resolved_to(), and its growth or decay is less than 1e-6
/// of its frequency, far less than what the mesh leaves in it.
///
/// A shaft without damping of its own has such vibrations on either side of the border of stability by next to nothing:
/// they decide on no verdict. The same shaft with every segment cut has others.
[[nodiscard]] bool is_of_elements(std::complex<double> lambda, double resolved_to);

/// The verdict of such a mode. Summaries of modes leave it out.
inline constexpr const char* not_resolved = "not resolved";

}  // namespace whirl::study
