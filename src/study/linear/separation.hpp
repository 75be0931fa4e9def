#pragma once
// Separation margins of peaks and critical speeds.

#include <optional>
#include <string>
#include <vector>

#include "whirl/deck/units.hpp"
#include "whirl/io/record.hpp"
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

/// A critical speed of `modes` as screen, report, tables and the service speed have it.
struct CriticalSpeed {
  std::string number;                      ///< by rising speed, from 1
  io::Quantity speed = {}, mode = {};      ///< `mode` is its number in the spectrum
  std::string whirl = {};                  ///< of its mode at the nearest computed speed; empty: not known
  io::Quantity log_decrement = {};         ///< of the mode there, at fixed speed
  io::Quantity amplification_factor = {};  ///< pi/log_decrement; no unit: it has no damping, or it grows
  io::Quantity separation_margin = {};     ///< no unit: no operating speed is known; so of the next
  io::Quantity required_margin = {};
  std::string stability = {};  ///< stable, undamped, unstable
  /// margin_verdict(), without damping of an infinite factor; `not_excited` where the mode turns backward on circles.
  std::string verdict = {};
};

/// Of a critical speed that is not far enough, and that unbalance does not excite.
inline constexpr const char* not_excited = "not excited";

/// The critical speeds that the summary of a `modes` study holds, by rising speed.
[[nodiscard]] std::vector<CriticalSpeed> critical_speeds_of(const io::StudySummary& summary);

/// Puts `head` + amplification_factor, separation_margin and required_margin of a critical speed with their bars into
/// the summary, from its speed and log decrement with theirs (not a number: none). N/(N2 - N1) of a mode by itself is
/// 1/(2 zeta), its log decrement 2 pi zeta: their product is pi. Nothing of a mode that grows, and no
/// amplification factor of one without damping; margins only with an operating range. Speeds in one unit. Source: API
/// 617; API 684 (2005), 2.5 (separation.hpp).
void put_margins(io::StudySummary& summary, const std::string& head, double speed, double speed_error, double decrement,
                 double decrement_error, const std::optional<deck::Range>& operating);

/// The critical speeds of the summary as a table, with the columns that the screen shows, and their bars.
void put_criticals(io::Group& table, const io::StudySummary& summary);

}  // namespace whirl::study
