#pragma once
// Peaks of a response over speed: where they are, how high, how wide, and what is left to settle.

#include <cstddef>
#include <limits>
#include <vector>

namespace whirl::study {

inline constexpr double peak_tolerance = 1e-5;   ///< of the speed of a peak
inline constexpr double width_tolerance = 1e-3;  ///< of the width of a peak, for its amplification factor

/// What the refinement of a peak leaves of its values, relative to them; not a number where it did not settle.
struct PeakErrors {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double speed = unknown, height = unknown, factor = unknown;
};

/// Heights (semi-major axes, m) of one place over rising speeds (rad/s).
struct ResponseCurve {
  std::vector<double> speed, height;

  /// Samples higher than their neighbours; of two that are nearer than the tolerance the higher one.
  [[nodiscard]] std::vector<std::size_t> tops() const;
};

/// A peak at one of the samples. Where a resonance is narrower than the tolerance of its speed, as an undamped one is,
/// it has no height and no factor: not a number.
struct Peak {
  double speed = 0, height = 0, amplification = 0;  ///< rad/s; m; N/(N2 - N1) at 0.707 of the height (API 684)
  PeakErrors errors;
};
[[nodiscard]] Peak peak_at(const ResponseCurve& curve, std::size_t top);

/// Speeds [rad/s] that settle the place of a top; none if it is settled. `pass` counts the attempts.
void ask_for_top(const ResponseCurve& curve, std::size_t top, int pass, std::vector<double>& speeds);
/// Speeds [rad/s] that settle the width of a peak.
void ask_for_width(const ResponseCurve& curve, std::size_t top, std::vector<double>& speeds);

}  // namespace whirl::study
