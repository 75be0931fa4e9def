#pragma once
// Numbers and tables as a person reads them on a screen.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "whirl/io/rounded.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::app {

/// Widest line of a table: that of the terminal, 100 where there is none. What is wider goes on below, with the first
/// column again.
[[nodiscard]] std::size_t widest_line();

/// Four digits; "-" if there is none.
[[nodiscard]] std::string number(std::optional<double> value);

using io::with_uncertainty;

/// The value times `factor` with two digits of its bar, else four digits; "-" if there is none.
[[nodiscard]] std::string cell_of(const io::Quantity& q, double factor = 1);

/// The same, of four digits without a bar where that is below 0.2 % of the value.
[[nodiscard]] std::string brief_cell(const io::Quantity& q, double factor = 1);

/// `text` in lines of at most widest_line after `indent` spaces, more after the first one.
[[nodiscard]] std::string in_lines(const std::string& text, std::size_t indent);

/// The values of a study by name.
class Values {
public:
  explicit Values(const io::StudySummary& s);
  /// Without a unit if there is none.
  [[nodiscard]] io::Quantity quantity(const std::string& name) const;
  [[nodiscard]] std::optional<double> get(const std::string& name) const;
  [[nodiscard]] std::string unit(const std::string& name) const;  ///< empty if there is none
  [[nodiscard]] double bar(const std::string& name) const;        ///< not a number: unknown
  /// cell_of() and brief_cell() of the value.
  [[nodiscard]] std::string cell(const std::string& name, double factor = 1) const;
  [[nodiscard]] std::string brief(const std::string& name, double factor = 1) const;
  /// What stands between `head` and `tail` in the names that have both, in the order of the study.
  [[nodiscard]] static std::vector<std::string> between(const io::StudySummary& s, const std::string& head,
                                                        const std::string& tail);

private:
  std::map<std::string, io::Quantity> all_;
};

/// Rows of cells, right-aligned below their heads, the first column left-aligned. Columns without a number are left
/// out. A table wider than widest_line goes on below with the first column again.
class Grid {
public:
  explicit Grid(std::vector<std::string> heads) : rows_{std::move(heads)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  [[nodiscard]] std::string text() const;

private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace whirl::app
