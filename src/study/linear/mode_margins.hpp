#pragma once
// Separation margins of critical speeds.

#include <optional>
#include <string>

#include "whirl/deck/units.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

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
