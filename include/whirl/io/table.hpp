#pragma once
// Row-wise building of result tables.

#include <string>
#include <vector>

#include "whirl/io/record.hpp"

namespace whirl::io {

/// A table of real columns, each of one number or of a fixed row of numbers per table row.
///
///     Table t({{"parameter", "rpm", "speed"}, Table::wide("x", "m", "journal position", {"B1", "B2"})});
///     t.append({{3600.0}, x});
///     t.write(group);        // datasets parameter[rows], x[rows][2]
class Table {
public:
  struct Column {
    std::string name;
    std::string unit;
    std::string description;
    Shape row_shape = {};                  ///< shape of one cell; empty is a single number
    std::vector<std::string> labels = {};  ///< of the numbers of a cell with one axis
  };

  /// A column of as many numbers per row as there are labels, which name them.
  [[nodiscard]] static Column wide(std::string name, std::string unit, std::string description,
                                   std::vector<std::string> labels) {
    const std::size_t n = labels.size();
    return {std::move(name), std::move(unit), std::move(description), {n}, std::move(labels)};
  }

  Table() = default;
  explicit Table(std::vector<Column> columns);

  /// Appends one row: one vector per column, each of its column's cell size. core::Bug if the sizes do not fit.
  void append(const std::vector<std::vector<double>>& row);
  /// Appends one row of a table whose columns are all single numbers.
  void append(std::initializer_list<double> row);
  /// Removes the rows from `rows` on.
  void truncate(std::size_t rows);

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// All values of a column, row after row.
  [[nodiscard]] const std::vector<double>& column(const std::string& name) const;

  /// Writes one dataset per column into `group`, of shape [rows][row_shape...], and their order as the attribute
  /// `columns`.
  void write(Group& group) const;
  /// Reads rows back that `write` made with the same columns; core::Error if a column is missing or has another shape.
  void read(const Group& group);

private:
  std::vector<Column> columns_;
  std::vector<std::vector<double>> values_;
  std::size_t rows_ = 0;
};

}  // namespace whirl::io
