#pragma once
// The numbers that a study was asked for, in units that a person reads.

#include <string>

#include "whirl/io/summary.hpp"

namespace whirl::app {

/// Loads and journal positions, critical speeds with margins or the least damped modes, peaks with amplification
/// factors and margins, thresholds, cycles asked for, kinds of motion, limits of a bearing map, variants of a sweep,
/// with their bars: a few lines or a small table by the kind of the study, from its values. Empty if it has none of
/// these. Lengths in um (mm from 10 mm on), forces in kN, pressures in MPa, margins in percent.
[[nodiscard]] std::string highlights(const io::StudySummary& study);

/// "5021.4 +- 6.9 rpm": two digits of the uncertainty, seven of the value at most; the unit 1 is not written.
[[nodiscard]] std::string with_uncertainty(double value, double uncertainty, const std::string& unit);

/// A value with its bar in the unit that a person reads: "23.2 +- 0.4 um", "61.3 degC".
[[nodiscard]] std::string in_usual_unit(const io::Quantity& q);

}  // namespace whirl::app
