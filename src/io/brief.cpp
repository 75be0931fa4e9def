#include "whirl/io/brief.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace whirl::io {
namespace {

struct Scale {
  const char* unit;  // that a number is given in
  double from;       // smallest size of which `shown` is read
  double factor;
  const char* shown;
};
constexpr double all_sizes = 0;
// By unit, and by rising size in it.
constexpr Scale scales[] = {{"m", all_sizes, 1e6, "um"},
                            {"m", 0.01, 1e3, "mm"},
                            {"m", 2, 1, "m"},
                            {"N", 1e4, 1e-3, "kN"},
                            {"N", 1e7, 1e-6, "MN"},
                            {"N m", 1e4, 1e-3, "kN m"},
                            {"N/m", 1e3, 1e-3, "kN/m"},
                            {"N/m", 1e6, 1e-6, "MN/m"},
                            {"N/m", 1e9, 1e-9, "GN/m"},
                            {"N s/m", 1e4, 1e-3, "kN s/m"},
                            {"N s/m", 1e7, 1e-6, "MN s/m"},
                            {"Pa", 1e3, 1e-3, "kPa"},
                            {"Pa", 1e5, 1e-6, "MPa"},
                            {"Pa s", all_sizes, 1e3, "mPa s"},
                            {"W", all_sizes, 1e3, "mW"},
                            {"W", 0.1, 1, "W"},
                            {"W", 1e4, 1e-3, "kW"},
                            {"W", 1e7, 1e-6, "MW"},
                            {"m^3/s", all_sizes, 6e4, "l/min"},
                            {"kg/s", all_sizes, 1e3, "g/s"},
                            {"kg/s", 1, 1, "kg/s"},
                            {"rad", all_sizes, 180 / std::numbers::pi, "deg"},
                            {"kg m", all_sizes, 1e6, "g mm"},
                            {"kg m", 1e-3, 1e3, "kg mm"}};

Scale scale_of(const std::string& unit, double size) {
  Scale found{unit.c_str(), 0, 1, unit == "1" ? "" : unit.c_str()};
  for (const Scale& s : scales)
    if (unit == s.unit && size >= s.from) found = s;
  return found;
}

// `count` significant digits, without a tail of zeros behind the point.
std::string digits(double value, int count) {
  if (value == 0) return "0";
  const double size = std::abs(value);
  if (size < 1e-4 || size >= 1e7) {
    const std::string text = fmt::format("{:.{}e}", value, count - 1);
    const std::size_t power = text.find('e'), last = text.find_last_not_of('0', power - 1);
    return text.substr(0, text[last] == '.' ? last : last + 1) + text.substr(power);
  }
  const int places = std::max(0, count - 1 - static_cast<int>(std::floor(std::log10(size))));
  std::string text = fmt::format("{:.{}f}", value, places);
  if (places > 0) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

// The largest number of a column; 0: it has none.
double largest_of(const BriefTable& table, std::size_t c) {
  double largest = 0;
  for (const auto& row : table.rows)
    if (row[c].is_number() && std::isfinite(row[c].quantity.value))
      largest = std::max(largest, std::abs(row[c].quantity.value));
  return largest;
}

// The scale of a column: its own, or that of a column of smaller numbers with the same unit, as far as numbers of up to
// four digits before the point come out. MN/m beside GN/m in one matrix would be misread.
Scale scale_in(const BriefTable& table, std::size_t c) {
  constexpr double most = 1e4;
  const double own = largest_of(table, c);
  Scale scale = scale_of(table.columns[c].unit, own);
  for (std::size_t other = 0; other < table.columns.size(); ++other) {
    const double size = largest_of(table, other);
    if (other == c || !(size > 0) || table.columns[other].unit != table.columns[c].unit) continue;
    const Scale finer = scale_of(table.columns[other].unit, size);
    if (finer.factor > scale.factor && finer.factor * own < most) scale = finer;
  }
  return scale;
}

void typeset(BriefTable& table) {
  std::vector<std::size_t> kept;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    BriefColumn& column = table.columns[c];
    const bool filled = c == 0 || std::ranges::any_of(table.rows, [c](const auto& r) {
                          return r[c].is_number() || !r[c].text.empty();
                        });
    if (!filled) continue;
    kept.push_back(c);
    const Scale scale = scale_in(table, c);
    column.shown = scale.shown;
    column.factor = scale.factor;
    for (auto& row : table.rows) {
      BriefCell& cell = row[c];
      if (!cell.is_number()) continue;
      const double bar = cell.quantity.bar();
      cell.text = column.unit.empty()
                      ? reading(cell.quantity)
                      : reading(scale.factor * cell.quantity.value, bar > 0 ? scale.factor * bar : no_value);
    }
  }
  BriefTable out{
      std::move(table.caption), {}, std::vector<std::vector<BriefCell>>(table.rows.size()), std::move(table.note)};
  for (const std::size_t c : kept) {
    out.columns.push_back(std::move(table.columns[c]));
    for (std::size_t r = 0; r < table.rows.size(); ++r) out.rows[r].push_back(std::move(table.rows[r][c]));
  }
  table = std::move(out);
}

}  // namespace

void typeset(Brief& brief) {
  std::erase(brief.sentences, "");
  std::erase_if(brief.tables, [](const BriefTable& t) { return t.rows.empty(); });
  for (BriefTable& table : brief.tables) typeset(table);
}

std::string reading(double value, double uncertainty) {
  constexpr double below_digits = 1e-6;
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "without limit" : "-without limit";
  if (!(uncertainty > 0) || !std::isfinite(uncertainty)) return digits(value, 5);
  if (uncertainty < below_digits * std::abs(value)) return digits(value, 6);
  const double largest = std::max(std::abs(value), uncertainty);
  if (largest < 1e-4 || largest >= 1e7) {
    const int power = static_cast<int>(std::floor(std::log10(largest)));
    const double one = std::pow(10, power);
    return fmt::format("({})e{:+03d}", reading(value / one, uncertainty / one), power);
  }
  const int places = std::max(0, 1 - static_cast<int>(std::floor(std::log10(uncertainty))));
  std::string shown = fmt::format("{:.{}f}", value, places);
  if (shown.find_first_not_of("-0.") == std::string::npos) shown = shown.substr(shown.starts_with('-') ? 1 : 0);
  return fmt::format("{} +- {:.{}f}", shown, uncertainty, places);
}

std::string reading(const Quantity& q) {
  const Scale scale = scale_of(q.unit, std::abs(q.value));
  const std::string text = reading(scale.factor * q.value, q.bar() > 0 ? scale.factor * q.bar() : no_value);
  return text + (*scale.shown == '\0' || text == "-" ? "" : std::string(" ") + scale.shown);
}

}  // namespace whirl::io
