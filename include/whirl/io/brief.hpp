#pragma once
// What a reader of a study wants to know first, as data: screen, report and users' programs show the same.

#include <string>
#include <utility>
#include <vector>

#include "whirl/io/quantity.hpp"

namespace whirl::io {

/// A word, a number, or nothing.
struct BriefCell {
  BriefCell() = default;
  BriefCell(std::string words) : text(std::move(words)) {}
  BriefCell(const char* words) : text(words) {}
  BriefCell(Quantity number) : quantity(std::move(number)) {}

  std::string text = {};   ///< the word; of a number what a person reads, which typeset() writes
  Quantity quantity = {};  ///< in the unit of its column, or in its own if the column has none
  /// True if it holds a number; infinity counts, not-a-number does not.
  [[nodiscard]] bool is_number() const { return !(quantity.value != quantity.value); }
};

struct BriefColumn {
  std::string name = {};
  std::string unit = {};   ///< of its numbers: SI, or the unit of the study; "1": none; empty: each number has a unit
  std::string shown = {};  ///< unit in which a person reads them; typeset() chooses it
  double factor = 1;       ///< from `unit` to `shown`
};

struct BriefTable {
  std::string caption = {};
  std::vector<BriefColumn> columns = {};
  std::vector<std::vector<BriefCell>> rows = {};  ///< a cell for each column
  std::string note = {};                          ///< what has to be known to read it; or empty
};

/// The answer of a study: a few sentences, then tables, the most important first.
struct Brief {
  std::vector<std::string> sentences = {};
  std::vector<BriefTable> tables = {};
  bool tells_stability = false;  ///< the sentences hold the verdict of the study
};

/// Chooses the unit of each column by its largest number (um, kN, MPa, deg, ...) and writes the texts of the numbers.
/// Removes empty sentences, tables without rows, and empty columns other than the first.
void typeset(Brief& brief);

/// A number as a person reads it: two digits of its bar and the value as far as that reaches; six digits where the bar
/// is below them, five where it is not known; "-" where there is no number, "without limit" of infinity.
[[nodiscard]] std::string reading(double value, double uncertainty = no_value);
/// The same with the unit that suits its size: "23.2 +- 0.4 um", "49.1 N".
[[nodiscard]] std::string reading(const Quantity& q);

}  // namespace whirl::io
