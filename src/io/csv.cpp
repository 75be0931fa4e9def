#include "whirl/io/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

#include "io/atomic_file.hpp"
#include "whirl/io/hdf5.hpp"

namespace whirl::io {
namespace {

constexpr std::size_t most_cells = 1000000;

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::string text_of(double x) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
  std::array<char, 32> digits{};
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr};
}
std::string text_of(std::int64_t x) {
  return std::to_string(x);
}
std::string text_of(const std::string& x) {
  return x;
}

std::string value(const Dataset& d, std::size_t k) {
  return std::visit([k](const auto& all) { return text_of(all[k]); }, d.values);
}

// Names in the order in which a table has its columns; a group that is no such table has none, and is in that of its
// map.
std::vector<std::string> order(const Group& group) {
  std::vector<std::string> names;
  if (group.has_attribute("columns")) {
    // Names with spaces stand one a line.
    const std::string& all = group.text("columns");
    const char between = all.find('\n') == std::string::npos ? ' ' : '\n';
    std::istringstream words(all);
    for (std::string word; std::getline(words, word, between);)
      if (group.has_dataset(word)) names.push_back(word);
  }
  for (const std::size_t axes : {1UL, 2UL, 3UL})
    for (const auto& [name, d] : group.datasets())
      if (d.shape.size() == axes && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

struct TextColumn {
  std::string head;
  const Dataset* data;
  std::size_t first, stride;
};

// Of all axes but the first: `name.B1`, `name.order 2.B1`; places without a name are numbered from 1.
void add_columns(const std::string& name, const Dataset& d, std::vector<TextColumn>& columns) {
  const std::string unit = d.unit.empty() || d.unit == "1" ? "" : " [" + d.unit + "]";
  std::size_t width = 1;
  for (std::size_t axis = 1; axis < d.shape.size(); ++axis) width *= d.shape[axis];
  for (std::size_t k = 0; k < width; ++k) {
    std::string head;
    std::size_t rest = k;
    for (std::size_t axis = d.shape.size(); axis-- > 1;) {
      const std::size_t place = rest % d.shape[axis];
      rest /= d.shape[axis];
      const bool named = axis <= d.labels.size() && d.labels[axis - 1].size() == d.shape[axis];
      head = "." + (named ? d.labels[axis - 1][place] : std::to_string(place + 1)) + head;
    }
    columns.push_back({name + head + unit, &d, k, width});
  }
}

// A dataset of three axes is a table where all its places have names.
bool fits_a_table(const Dataset& d) {
  if (d.share) return false;
  return d.shape.size() < 3 || (d.shape.size() == 3 && d.labels.size() == 2 && !d.labels[0].empty());
}

// Rows of a table: the first extent of its widest datasets, which the others share; nothing if the group is no table.
std::optional<std::size_t> rows_of(const Group& group) {
  std::optional<std::size_t> rows;
  std::size_t most = 0;
  for (const auto& [name, d] : group.datasets()) {
    if (!fits_a_table(d)) return {};
    most = std::max(most, d.shape.size());
  }
  if (most == 0) return {};
  for (const auto& [name, d] : group.datasets()) {
    if (d.shape.size() != most) continue;
    if (rows && *rows != d.shape[0]) return {};
    rows = d.shape[0];
  }
  return rows;
}

// Nothing if the group is no table.
std::string text_of(const Group& group) {
  const std::optional<std::size_t> rows = rows_of(group);
  if (!rows) return {};
  std::vector<TextColumn> columns;
  const bool wide = std::any_of(group.datasets().begin(), group.datasets().end(),
                                [](const auto& d) { return !d.second.labels.empty(); });
  for (const std::string& name : order(group)) {
    const Dataset& d = group.dataset(name);
    // Nodes that name columns are no column, were they as many as there are rows.
    if (wide && name == "node" && d.shape.size() == 1) continue;
    if (!d.shape.empty() && d.shape[0] == *rows) add_columns(name, d, columns);
  }
  if (columns.empty() || columns.size() * std::max<std::size_t>(*rows, 1) > most_cells) return {};
  std::string out;
  for (const TextColumn& c : columns) out += (&c == &columns.front() ? "" : ",") + quoted(c.head);
  out += '\n';
  for (std::size_t row = 0; row < *rows; ++row) {
    for (const TextColumn& c : columns)
      out += (&c == &columns.front() ? "" : ",") + quoted(value(*c.data, row * c.stride + c.first));
    out += '\n';
  }
  return out;
}

void collect(const Group& group, const std::string& path, const std::function<void(CsvFile)>& out) {
  if (group.has_attribute("restart")) return;
  if (is_left(group)) return collect(with_contents(group), path, out);
  if (!path.empty())
    if (std::string text = text_of(group); !text.empty()) out({path, std::move(text), {}});
  for (const auto& [name, inner] : group.groups()) collect(inner, path.empty() ? name : path + "." + name, out);
}

}  // namespace

void write_csv(const std::filesystem::path& path, const CsvFile& table) {
  replace_file(path, table.text);
}

void each_csv_table(const Group& tree, const std::function<void(const CsvFile&)>& visit) {
  std::set<std::string> taken;
  collect(tree, "", [&](CsvFile table) {
    const std::string name = plain_name(table.name);
    table.file = name + ".csv";
    for (int k = 2; !taken.insert(table.file).second; ++k) table.file = name + "_" + std::to_string(k) + ".csv";
    visit(table);
  });
}

std::vector<CsvFile> csv_tables(const Group& tree) {
  std::vector<CsvFile> out;
  each_csv_table(tree, [&](const CsvFile& table) { out.push_back(table); });
  return out;
}

}  // namespace whirl::io
