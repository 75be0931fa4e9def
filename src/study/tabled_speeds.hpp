#pragma once
// Speeds at which tables of coefficients have a row.

#include <cstddef>
#include <string>
#include <vector>

#include "whirl/io/summary.hpp"
#include "whirl/system/options.hpp"

namespace whirl::study {

/// Puts a speed between rising ones; not one of them, and none beyond their ends.
void put_between(std::vector<double>& speeds, double at);

/// Speeds [rad/s] strictly between `from` and `to` at which a table of an element or of a bearing's coefficients has a
/// row, rising. Between two rows each coefficient lies between its values there, so that a range of instability that a
/// table makes shows at a row, and may show at no other speed. Of more rows than `asked`, 24, or 100,000 over the
/// `states` of the machine, as many are chosen, evenly; a warning, with speeds in `unit`, says so.
[[nodiscard]] std::vector<double> tabled_speeds(const system::Machine& machine, double from, double to,
                                                std::size_t asked, long states, io::StudySummary& summary,
                                                const std::string& unit);

}  // namespace whirl::study
