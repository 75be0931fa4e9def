#include <fmt/core.h>

#include <filesystem>
#include <unordered_set>

#include "whirl/core/error.hpp"
#include "whirl/deck/load.hpp"

namespace whirl::deck {
namespace {

using core::InputError;

constexpr std::size_t most_values = 300000;

struct Cell {
  std::string text;
  int column = 1;  // in characters, 1-based
};

std::string trimmed(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t' || s.back() == '\r')) s.remove_suffix(1);
  return std::string(s);
}

// Cells of one line; a quoted cell may hold commas and doubled quotes.
std::vector<Cell> cells_of(std::string_view line, const Place& place) {
  std::vector<Cell> cells(1);
  bool quoted = false;
  int column = 1;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back().text += '"';
      ++i;
      ++column;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.push_back({{}, column + 1});
    } else {
      cells.back().text += c;
    }
    if ((static_cast<unsigned char>(c) & 0xC0) != 0x80) ++column;
  }
  if (quoted) throw InputError(place.text() + ": a quote is not closed");
  for (Cell& c : cells) {
    for (char x : c.text) {
      if (x != ' ') break;
      ++c.column;
    }
    c.text = trimmed(c.text);
  }
  return cells;
}

struct Column {
  std::string key;
  std::string unit;
  Place place;
};

Column column_of(const Cell& cell, const Place& place) {
  Column c{cell.text, {}, place};
  const std::size_t open = cell.text.find('[');
  if (open != std::string::npos) {
    if (cell.text.back() != ']') throw InputError(place.text() + ": a header cell is written `key [unit]`");
    c.key = trimmed(std::string_view(cell.text).substr(0, open));
    c.unit = trimmed(std::string_view(cell.text).substr(open + 1, cell.text.size() - open - 2));
  }
  if (c.key.empty()) throw InputError(place.text() + ": a header cell is empty");
  try {
    require_key(c.key);
  } catch (const InputError& e) {
    throw InputError(place.text() + ": " + e.what());
  }
  return c;
}

}  // namespace

Node parse_table(std::string_view text, const std::string& source) {
  const auto name = std::make_shared<const std::string>(source);
  std::vector<Column> columns;
  std::size_t n_values = 0;
  Node rows = Node::list();
  rows.place = {name, 1, 1};
  int line = 0;
  while (!text.empty()) {
    ++line;
    const std::size_t end = text.find('\n');
    const std::string_view row = text.substr(0, end);
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    if (trimmed(row).empty()) continue;
    const std::vector<Cell> cells = cells_of(row, {name, line, 1});
    if (columns.empty()) {
      std::unordered_set<std::string> keys;
      for (const Cell& c : cells) {
        Column column = column_of(c, {name, line, c.column});
        if (!keys.insert(column.key).second)
          throw InputError(fmt::format("{}: column '{}' is given twice", column.place.text(), column.key));
        columns.push_back(std::move(column));
      }
      continue;
    }
    if (cells.size() != columns.size())
      throw InputError(
          fmt::format("{}:{}:1: {} cells in a table of {} columns", source, line, cells.size(), columns.size()));
    n_values += cells.size() + 1;
    if (n_values > most_values)
      throw InputError(fmt::format("{}:{}:1: the table has more than {} values", source, line, most_values));
    Node entry = Node::map();
    entry.table_row = true;
    entry.place = {name, line, 1};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].text.empty()) continue;
      Node value = Node::scalar(cells[i].text + (columns[i].unit.empty() ? "" : " " + columns[i].unit));
      value.place = {name, line, cells[i].column};
      value.key_place = columns[i].place;
      value.table_row = true;
      entry.set(columns[i].key, std::move(value));
    }
    rows.push(std::move(entry));
  }
  if (rows.items.empty()) throw InputError(fmt::format("{}:1:1: the table has no rows", source));
  return rows;
}

bool names_table(const Node& node) {
  return node.kind == Node::Kind::scalar && node.text.size() > 4 && node.text.ends_with(".csv");
}

Node load_table(const Node& node, const Files& files) {
  const std::filesystem::path path(node.text);
  const std::string full = path.is_absolute()
                               ? path.string()
                               : (std::filesystem::path(node.place.directory()) / path).lexically_normal().string();
  std::string text;
  try {
    text = files.read_text(full);
  } catch (const InputError& e) {
    throw InputError(node.place.text() + ": " + e.what());
  }
  Node table = parse_table(text, full);
  table.key = node.key;
  table.key_place = node.key_place;
  return table;
}

}  // namespace whirl::deck
