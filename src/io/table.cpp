#include "whirl/io/table.hpp"

#include "whirl/core/error.hpp"

namespace whirl::io {
namespace {

std::size_t cell_size(const Table::Column& c) {
  std::size_t n = 1;
  for (std::size_t extent : c.row_shape) n *= extent;
  return n;
}

Shape full_shape(const Table::Column& c, std::size_t rows) {
  Shape shape{rows};
  shape.insert(shape.end(), c.row_shape.begin(), c.row_shape.end());
  return shape;
}

}  // namespace

Table::Table(std::vector<Column> columns) : columns_(std::move(columns)), values_(columns_.size()) {}

void Table::append(const std::vector<std::vector<double>>& row) {
  core::require(row.size() == columns_.size(), "a table row has another number of columns");
  for (std::size_t k = 0; k < row.size(); ++k)
    core::require(row[k].size() == cell_size(columns_[k]), "a table cell has another size");
  for (std::size_t k = 0; k < row.size(); ++k) values_[k].insert(values_[k].end(), row[k].begin(), row[k].end());
  ++rows_;
}

void Table::append(std::initializer_list<double> row) {
  std::vector<std::vector<double>> cells;
  for (double x : row) cells.push_back({x});
  append(cells);
}

void Table::truncate(std::size_t rows) {
  if (rows >= rows_) return;
  rows_ = rows;
  for (std::size_t k = 0; k < columns_.size(); ++k) values_[k].resize(rows * cell_size(columns_[k]));
}

const std::vector<double>& Table::column(const std::string& name) const {
  for (std::size_t k = 0; k < columns_.size(); ++k)
    if (columns_[k].name == name) return values_[k];
  throw core::Bug("internal error: table has no column '" + name + "'");
}

void Table::write(Group& group) const {
  std::string names;
  for (const Column& c : columns_) names += (names.empty() ? "" : " ") + c.name;
  group.set("columns", names);
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const Column& c = columns_[k];
    group.put(c.name, full_shape(c, rows_), values_[k], c.unit, c.description);
    if (!c.labels.empty()) group.label(c.name, {c.labels});
  }
}

void Table::read(const Group& group) {
  std::vector<std::vector<double>> values;
  std::size_t rows = 0;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const Column& c = columns_[k];
    const Shape& shape = group.dataset(c.name).shape;
    if (k == 0 && !shape.empty()) rows = shape[0];
    if (shape != full_shape(c, rows)) throw core::Error("table column '" + c.name + "' has another shape");
    values.push_back(group.reals(c.name));
  }
  values_ = std::move(values);
  rows_ = rows;
}

}  // namespace whirl::io
