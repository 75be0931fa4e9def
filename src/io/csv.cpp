#include "whirl/io/csv.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include "io/atomic_file.hpp"

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
  for (const std::size_t axes : {1UL, 2UL})
    for (const auto& [name, d] : group.datasets())
      if (d.shape.size() == axes && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

class Columns {
public:
  explicit Columns(const Group& tree) {
    for (const char* group : {"bearings", "places"})
      if (tree.has_group(group) && tree.group(group).has_dataset("name")) places_ = &tree.group(group).dataset("name");
  }

  // Nothing if the group is no table.
  [[nodiscard]] std::string text(const Group& group) const {
    for (const auto& [name, d] : group.datasets())
      if (d.shape.size() > 2 || d.share) return {};
    std::size_t rows = 0;
    bool known = false, two = false;
    for (const std::size_t axes : {2UL, 1UL}) {
      for (const auto& [name, d] : group.datasets()) {
        if (d.shape.size() != axes) continue;
        if (known && !two && d.shape[0] != rows) return {};
        if (known && two && axes == 2 && d.shape[0] != rows) return {};
        if (!known || axes == 2) rows = d.shape[0];
        known = true;
        two = two || axes == 2;
      }
    }
    struct Column {
      std::string head;
      const Dataset* data;
      std::size_t first, stride;
    };
    std::vector<Column> columns;
    for (const std::string& name : order(group)) {
      const Dataset& d = group.dataset(name);
      if (d.shape.empty() || d.shape.size() > 2 || d.shape[0] != rows) continue;
      const std::string unit = d.unit.empty() || d.unit == "1" ? "" : " [" + d.unit + "]";
      const std::size_t width = d.shape.size() == 2 ? d.shape[1] : 1;
      for (std::size_t k = 0; k < width; ++k)
        columns.push_back(
            {name + (d.shape.size() == 2 ? "." + label(group, rows, width, k) : "") + unit, &d, k, width});
    }
    if (columns.empty() || columns.size() * std::max<std::size_t>(rows, 1) > most_cells) return {};
    std::string out;
    for (const Column& c : columns) out += (&c == &columns.front() ? "" : ",") + quoted(c.head);
    out += '\n';
    for (std::size_t row = 0; row < rows; ++row) {
      for (const Column& c : columns)
        out += (&c == &columns.front() ? "" : ",") + quoted(value(*c.data, row * c.stride + c.first));
      out += '\n';
    }
    return out;
  }

private:
  [[nodiscard]] std::string label(const Group& group, std::size_t rows, std::size_t width, std::size_t k) const {
    if (width != rows)
      for (const auto& [name, d] : group.datasets())
        if (d.shape.size() == 1 && d.shape[0] == width) return value(d, k);
    if (places_ && places_->size() == width) return value(*places_, k);
    return std::to_string(k + 1);
  }

  const Dataset* places_ = nullptr;
};

void collect(const Columns& columns, const Group& group, const std::string& path, std::vector<CsvFile>& out) {
  if (group.has_attribute("restart")) return;
  if (!path.empty())
    if (std::string text = columns.text(group); !text.empty()) out.push_back({path, std::move(text), {}});
  for (const auto& [name, inner] : group.groups())
    collect(columns, inner, path.empty() ? name : path + "." + name, out);
}

}  // namespace

void write_csv(const std::filesystem::path& path, const CsvFile& table) {
  replace_file(path, table.text);
}

std::vector<CsvFile> csv_tables(const Group& tree) {
  std::vector<CsvFile> out;
  collect(Columns(tree), tree, "", out);
  std::set<std::string> taken;
  for (CsvFile& table : out) {
    const std::string name = plain_name(table.name);
    table.file = name + ".csv";
    for (int k = 2; !taken.insert(table.file).second; ++k) table.file = name + "_" + std::to_string(k) + ".csv";
  }
  return out;
}

}  // namespace whirl::io
