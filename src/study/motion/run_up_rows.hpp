#pragma once
// The rows of a run-up, one a revolution, and the values that its summary has of them.

#include <string>
#include <string_view>
#include <vector>

#include "whirl/io/summary.hpp"
#include "whirl/io/table.hpp"

namespace whirl::study {

inline constexpr std::string_view not_faded =
    "the free vibration of the start has not faded when the run ends: amplitudes contain it";

/// Of speeds in `unit`; those of the shaft's nodes come last.
[[nodiscard]] std::vector<io::Table::Column> run_up_columns(const std::string& unit,
                                                            const std::vector<std::string>& bearings,
                                                            const std::vector<int>& nodes);

/// The largest amplitude of each place beyond the start, and where it was; a larger one of the start is told.
void put_peaks(io::StudySummary& summary, const io::Table& table, const std::string& column,
               const std::vector<std::string>& names, const std::string& unit);

/// The thinnest film of each bearing that has one, and where it was.
void put_thinnest(io::StudySummary& summary, const io::Table& table, const std::vector<std::string>& names,
                  const std::string& unit);

}  // namespace whirl::study
