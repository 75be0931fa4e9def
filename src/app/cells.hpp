#pragma once
// Text and tables as a person reads them on a screen.

#include <string>
#include <utility>
#include <vector>

namespace whirl::app {

/// Widest line of a table: that of the terminal or of COLUMNS, 100 where neither is known. What is wider goes on below,
/// with the first column again.
[[nodiscard]] std::size_t widest_line();

/// `text` in lines of at most widest_line after `indent` spaces, more after the first one.
[[nodiscard]] std::string in_lines(const std::string& text, std::size_t indent);

/// `text` as in_lines on a terminal, on one line of any length where other programs read it.
[[nodiscard]] std::string paragraph(const std::string& text, std::size_t indent);

/// Rows of cells below their heads: numbers right-aligned, words and the first column left-aligned. Empty columns are
/// left out. A table wider than widest_line goes on below with the columns that tell its rows apart and the rows that
/// go on. A remark stands below its row, in the last block.
class CellTable {
public:
  explicit CellTable(std::vector<std::string> heads) : rows_{std::move(heads)} {}
  void add(std::vector<std::string> row, std::string remark = {}) {
    rows_.push_back(std::move(row));
    remarks_.resize(rows_.size());
    remarks_.back() = std::move(remark);
  }
  [[nodiscard]] std::string text() const;

private:
  std::vector<std::vector<std::string>> rows_;
  std::vector<std::string> remarks_ = {};
};

}  // namespace whirl::app
