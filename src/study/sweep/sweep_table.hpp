#pragma once
// The table of a sweep: all values of all variants, and their trends.

#include <string>
#include <vector>

#include "study/findings.hpp"
#include "whirl/study/sweep/sweep.hpp"

namespace whirl::study {

/// What is known of one variant; the deck as it stands has no coordinates.
struct SweepRow {
  std::string name;
  std::vector<Coordinate> coordinates;
  std::vector<io::StudySummary> studies;
  std::vector<std::string> unusual = {};  ///< about its deck
};

/// Values of `study` as columns of a table: its named values, and of its bifurcations how many of each type there are,
/// where the k-th one is (TYPE.k, in the order along the branch), and the last of them (TYPE.last).
[[nodiscard]] std::vector<io::SweepColumn> columns_of(const io::StudySummary& study);

/// Columns of all rows, in the order in which they are met; names start with that of the study.
[[nodiscard]] std::vector<io::SweepColumn> table_of(const std::vector<SweepRow>& rows);

/// How each column changes along each quantity that distinguishes rows, the others the same. The sign of a change
/// counts if its bar, the sum of the two uncertainties, does not contain zero.
[[nodiscard]] std::vector<io::Trend> trends_of(const std::vector<SweepRow>& rows,
                                               const std::vector<io::SweepColumn>& columns);

/// Warnings of the rows, each once with the names of the rows that it belongs to. Words of different rows that differ
/// in their numbers alone are the same, and stand with the numbers of the first row; digits of names are no numbers. A
/// line of `given`, what is unusual about the deck as it stands, is left out if all variants have it.
[[nodiscard]] std::vector<std::string> warnings_of(const std::vector<SweepRow>& rows,
                                                   const std::vector<std::string>& given);

/// All of it into the results, with the verdict on each row.
void put_table(Findings& results, const std::vector<SweepRow>& rows, const std::vector<std::string>& given);

}  // namespace whirl::study
