#pragma once
// Peaks of a response over speed: where they are, how high, how wide, and what is left to settle.

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace whirl::study {

inline constexpr double peak_tolerance = 1e-5;    ///< of the speed of a peak
inline constexpr double width_tolerance = 1e-3;   ///< of the width of a peak, for its amplification factor
inline constexpr double motion_rounding = 1e-12;  ///< of the largest motion of a machine: smaller ones are rounding
/// Of its height that a peak stands above the curve on either side: less may be what the equilibria leave of their
/// equations, and rounding.
inline constexpr double height_tolerance = 1e-6;
/// Of its height: a peak that stands out more is one on any mesh that serves at all.
inline constexpr double little_prominence = 0.1;
/// Of the speed: nearer speeds say nothing new of a place that is known to peak_tolerance.
inline constexpr double least_step = 0.1 * peak_tolerance;

/// What the refinement of a peak leaves of its values, relative to them; not a number where it did not settle.
struct PeakErrors {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double speed = unknown, height = unknown, factor = unknown;
};

/// Heights (semi-major axes, m) of one place over rising speeds (rad/s). Where one is not a number the curve ends, and
/// begins anew behind it.
struct ResponseCurve {
  std::vector<double> speed, height;

  /// Samples from which the curve falls on either side by more than height_tolerance before it rises above them; of two
  /// that are nearer than the tolerance the higher one.
  [[nodiscard]] std::vector<std::size_t> tops() const;
};

/// A peak at one of the samples. One that is narrower than the tolerance of its speed has no height that could be told,
/// whether it is damped or not: height and factor are infinite. It has no factor, not a number, where the curve does
/// not fall to 0.707 of its height on both sides before the range ends or a higher peak rises.
struct Peak {
  double speed = 0, height = 0, amplification = 0;  ///< rad/s; m; N/(N2 - N1) at 0.707 of the height (API 684)
  PeakErrors errors;
  std::string no_factor = {};  ///< why it has no amplification factor

  [[nodiscard]] bool too_narrow() const { return height == std::numeric_limits<double>::infinity(); }
};
[[nodiscard]] Peak peak_at(const ResponseCurve& curve, std::size_t top);
/// The lowest samples on either side of a top before the curve rises above it or ends, if it stands above the higher
/// one of them by less than little_prominence; else nothing.
[[nodiscard]] std::vector<double> saddles_of(const ResponseCurve& curve, std::size_t top);

/// The height of the higher saddle.
[[nodiscard]] double saddle_height(const ResponseCurve& curve, const std::vector<double>& saddles);

/// Speeds [rad/s] that settle the place of a top; none if it is settled. `pass` counts the attempts.
void ask_for_top(const ResponseCurve& curve, std::size_t top, int pass, std::vector<double>& speeds);
/// Speeds [rad/s] that settle the width of a peak.
void ask_for_width(const ResponseCurve& curve, std::size_t top, std::vector<double>& speeds);
/// Speeds [rad/s] beside a peak where straight lines between samples would cut its flanks: from 1/2 to 20 half widths
/// on either side, so that the distances of neighbours from the top have a ratio of at most 1.8. The half width is N/(2
/// AF). None without a factor; a peak that is too narrow for one counts as one of AF 500.
void ask_for_flanks(const ResponseCurve& curve, std::size_t top, std::vector<double>& speeds);
/// Of the speeds that were asked for, rising, those that are at least least_step from each other and from the `known`
/// ones, which rise.
[[nodiscard]] std::vector<double> worth_asking(std::vector<double> speeds, const std::vector<double>& known);

}  // namespace whirl::study
