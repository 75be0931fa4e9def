#pragma once
// The peaks of a linear response as screen, report and pictures show them.

#include <optional>
#include <string>
#include <vector>

#include "study/linear/response_peaks.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Amplification factor from which on a machine is not driven through a resonance without more damping.
inline constexpr double high_amplification = 30;

/// Stability of the equilibrium at an undamped peak of a machine of which nothing grows, and how its note begins.
inline constexpr const char* undamped = "undamped";

/// Where margins are counted from: the operating range of a study, else its operating speed, else the service speed of
/// the machine. Empty if there is none of these.
[[nodiscard]] std::optional<deck::Range> operating_range(const std::optional<deck::Range>& range,
                                                         const std::optional<deck::Quantity>& speed,
                                                         const std::optional<deck::Quantity>& service);

/// Names of the values of a peak in a summary, and members of its entry.
struct PeakValue {
  const char* name;
  io::Quantity io::PeakEntry::*member;
};
[[nodiscard]] const std::vector<PeakValue>& peak_values();

/// The entry of a peak [rad/s, m] with speeds in `unit`; without bars. Height and amplification factor of one that is
/// too narrow for them are infinite, and its required margin is that of an infinite factor.
[[nodiscard]] io::PeakEntry entry_of(const std::string& place, const Peak& peak, const std::string& unit,
                                     const std::optional<deck::Range>& operating);

/// What a peak that is too narrow for a height says of itself: that of a mode without damping is `endless`.
[[nodiscard]] std::string narrow_words(bool endless);

/// Puts "operating_speed", or "operating_range.from" and ".to" where they differ, in the unit of the `range` that was
/// looked at. Warns where this leaves operating speeds out.
void put_operating_range(io::StudySummary& summary, const deck::Range& operating, const deck::Range& range);

/// Warns of amplification factors of peaks and critical speeds above high_amplification, in one sentence.
void warn_of_amplification(io::StudySummary& summary);

}  // namespace whirl::study
