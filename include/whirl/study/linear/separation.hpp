#pragma once
// How far a critical speed must stay from where a machine runs.

#include <string>

#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Separation margins, as fractions of the border of the operating range that the critical speed is nearest to.
struct Separation {
  double actual = 0;    ///< zero inside the range
  double required = 0;  ///< not a number if the amplification factor is; zero below 2.5: damped, no critical speed
};

/// With the amplification factor AF = N/(N2 - N1) of a peak:
///
///     below `from`  required = 0.17 (1 - 1/(AF - 1.5))           of `from`
///     above `to`    required = 0.10 + 0.17 (1 - 1/(AF - 1.5))    of `to`
///
/// Inside the range the actual margin is zero and the required one that of the nearer border. Any one unit of speed.
/// Source: API 617 (separation of lateral critical speeds); API 684 (2005), 2.5.
[[nodiscard]] Separation separation(double critical_speed, double amplification_factor, double from, double to);

/// Whether a critical speed or a peak keeps its distance, by its amplification factor and its margins with their bars:
/// "damped, not critical" (API 684: amplification below 2.5), "too near", "far enough"; "undetermined" where a bar
/// contains the limit. Empty without margins (no unit), and where there is no amplification factor.
[[nodiscard]] std::string margin_verdict(const io::Quantity& amplification_factor, const io::Quantity& actual,
                                         const io::Quantity& required);

/// The same of a critical speed of `modes`, of which the summary holds `head` + amplification_factor, separation_margin
/// and required_margin: with margins but no factor it has no damping, and its factor is infinite.
[[nodiscard]] std::string margin_verdict_of(const io::StudySummary& summary, const std::string& head);

/// Sense of whirl of critical speed K of `modes`: that of its mode at the nearest computed speed. Empty if not known.
[[nodiscard]] std::string whirl_of_critical(const io::StudySummary& summary, const std::string& k);

}  // namespace whirl::study
