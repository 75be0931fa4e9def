#include "study/sweep/sweep_table.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <string_view>

#include "study/sweep/verdict_words.hpp"

namespace whirl::study {
namespace {

using io::no_value;

// Two places of trends that differ by rounding only.
bool alike(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b));
}

// Rows along one quantity: their numbers and places, by rising place.
struct Line {
  const Coordinate* what = nullptr;
  std::string beside;
  std::vector<std::pair<double, std::size_t>> at;
};

std::vector<Line> lines_of(const std::vector<SweepRow>& rows) {
  std::vector<Line> lines;
  std::map<std::string, std::size_t> known;
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t a = 0; a < rows[r].coordinates.size(); ++a) {
      const Coordinate& c = rows[r].coordinates[a];
      if (!std::isfinite(c.value)) continue;
      std::string beside;
      bool given = std::isfinite(c.given);
      for (std::size_t b = 0; b < rows[r].coordinates.size(); ++b) {
        const Coordinate& o = rows[r].coordinates[b];
        if (b == a) continue;
        beside += beside.empty() ? "" : ", ";
        beside += std::isfinite(o.value) ? fmt::format("{} {:.9g}{}{}", o.quantity, o.value, o.unit == "1" ? "" : " ",
                                                       o.unit == "1" ? "" : o.unit)
                                         : o.quantity;
        given = given && alike(o.value, o.given);
      }
      const auto [place, added] = known.emplace(c.quantity + "|" + c.unit + "|" + beside, lines.size());
      if (added) {
        lines.push_back({&c, beside, {}});
        // The deck as it stands lies on every line whose other quantities are its own.
        if (given && rows.front().coordinates.empty()) lines.back().at.emplace_back(c.given, 0);
      }
      auto& at = lines[place->second].at;
      const bool there = std::any_of(at.begin(), at.end(), [&](const auto& x) { return alike(x.first, c.value); });
      if (!there) at.emplace_back(c.value, r);
    }
  for (Line& l : lines) std::sort(l.at.begin(), l.at.end());
  return lines;
}

// The second, third ... bifurcation of a branch is the same one in two variants only if both have as many of its type.
// The first and the last are what they are by definition.
class Comparable {
public:
  Comparable(const io::SweepColumn& column, const std::vector<io::SweepColumn>& all) {
    const std::size_t dot = column.name.rfind('.');
    const std::string number = column.name.substr(dot + 1);
    if (number == "1" || number.empty() || number.find_first_not_of("0123456789") != std::string::npos) return;
    const std::string count = column.name.substr(0, dot) + ".count";
    for (const auto& c : all)
      if (c.name == count) counts_ = &c.values;
  }
  [[nodiscard]] bool operator()(std::size_t a, std::size_t b) const {
    return !counts_ || (*counts_)[a] == (*counts_)[b];
  }

private:
  const std::vector<double>* counts_ = nullptr;
};

// The difference of two variants is rounding where it lies with its bar below this part of the largest value.
constexpr double rounding = 1e-8;

std::string sign_of(const io::Trend& t, double largest) {
  bool up = false, down = false, open = false, bare = false, same = false;
  for (std::size_t k = 0; k < t.difference.size(); ++k) {
    const double d = t.difference[k], bar = t.uncertainty[k];
    if (!std::isfinite(d)) continue;  // not comparable
    if (std::abs(d) + bar <= rounding * largest)
      same = true;
    else if (!std::isfinite(bar))
      bare = true;
    else if (!(std::abs(d) > bar))
      open = true;
    else
      (d > 0 ? up : down) = true;
  }
  if (up && down) return "mixed";
  if (bare) return "no bar";
  if (open) return "undetermined";
  return up ? "+" : down ? "-" : same ? "0" : "not comparable";
}

// Words with # for each number. Digits of names are none: behind a letter, _ or ., in quotes, and in "node 12".
std::string without_numbers(std::string_view text) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto digits_end = [&](std::size_t at) {
    while (at < text.size() && digit(text[at])) ++at;
    return at;
  };
  std::string out;
  const auto counts = [&](std::string_view thing) { return out.ends_with(thing); };
  for (std::size_t at = 0, end = 0; at < text.size(); at = end) {
    const char before = at > 0 ? text[at - 1] : ' ';
    end = at + 1;
    if (text[at] == '\'' && !letter(before) && !digit(before)) {
      end = std::min(text.find('\'', end), text.size() - 1) + 1;
    } else if (digit(text[at])) {
      end = digits_end(at);
      const auto things = {"node ",  "nodes ", "mode ",           "modes ",   "bearing ",
                           "plane ", "peak ",  "critical speed ", "segment ", "pad "};
      if (!letter(before) && before != '.' && std::ranges::none_of(things, counts)) {
        if (end + 1 < text.size() && text[end] == '.') end = digits_end(end + 1);
        if (end + 2 < text.size() && text[end] == 'e' && !letter(text[end + 1])) end = digits_end(end + 2);
        out += '#';
        continue;
      }
    }
    out += text.substr(at, end - at);
  }
  return out;
}

}  // namespace

std::vector<io::SweepColumn> columns_of(const io::StudySummary& study) {
  std::vector<io::SweepColumn> all;
  const auto add = [&](const std::string& name, const std::string& unit, double value, double uncertainty) {
    all.push_back({study.name + "." + name, unit, {value}, {uncertainty}});
  };
  for (const auto& [name, q] : study.values) {
    const auto bar = q.more.find("uncertainty");
    add(name, q.unit, q.value, bar == q.more.end() ? no_value : bar->second);
  }
  std::map<io::BifurcationType, int> count;
  std::map<io::BifurcationType, const io::Bifurcation*> last;
  for (const io::Bifurcation& b : study.bifurcations) {
    add(fmt::format("{}.{}", io::name_of(b.type), ++count[b.type]), b.unit, b.value, b.uncertainty);
    last[b.type] = &b;
  }
  for (const auto& [type, n] : count) {
    add(fmt::format("{}.last", io::name_of(type)), last[type]->unit, last[type]->value, last[type]->uncertainty);
    add(fmt::format("{}.count", io::name_of(type)), "1", n, 0);
  }
  return all;
}

std::vector<io::SweepColumn> table_of(const std::vector<SweepRow>& rows) {
  std::vector<io::SweepColumn> all;
  std::map<std::string, std::size_t> known;
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (const auto& study : rows[r].studies)
      for (const auto& c : columns_of(study)) {
        const auto [place, added] = known.emplace(c.name, all.size());
        if (added) {
          const bool counts = c.name.ends_with(".count");
          all.push_back({c.name, c.unit, std::vector<double>(rows.size(), counts ? 0 : no_value),
                         std::vector<double>(rows.size(), counts ? 0 : no_value)});
        }
        all[place->second].values[r] = c.values[0];
        all[place->second].uncertainties[r] = c.uncertainties[0];
      }
  return all;
}

std::vector<io::Trend> trends_of(const std::vector<SweepRow>& rows, const std::vector<io::SweepColumn>& columns) {
  std::vector<io::Trend> all;
  for (const Line& line : lines_of(rows))
    for (const io::SweepColumn& c : columns) {
      io::Trend t{c.name, line.what->quantity, line.what->unit, line.beside, {}, {}, {}, {}, {}};
      const Comparable comparable(c, columns);
      std::size_t before = 0;
      for (const auto& [at, r] : line.at) {
        if (!std::isfinite(c.values[r])) continue;
        if (!t.at.empty()) {
          const bool alike = comparable(before, r);
          t.difference.push_back(alike ? c.values[r] - c.values[before] : no_value);
          t.uncertainty.push_back(alike ? c.uncertainties[r] + c.uncertainties[before] : no_value);
        }
        t.variants.push_back(rows[r].name);
        t.at.push_back(at);
        before = r;
      }
      if (t.difference.empty()) continue;
      double largest = 0;
      for (const auto& [at, r] : line.at)
        if (std::isfinite(c.values[r])) largest = std::max(largest, std::abs(c.values[r]));
      t.sign = sign_of(t, largest);
      all.push_back(std::move(t));
    }
  return all;
}

std::vector<std::string> warnings_of(const std::vector<SweepRow>& rows, const std::vector<std::string>& given) {
  struct Kept {
    std::string study, text;
    std::vector<std::size_t> rows = {};
    bool differ = false;
  };
  std::vector<Kept> all;
  std::map<std::pair<std::string, int>, std::size_t> known;
  std::map<std::string, int> number;  // of texts of these words in one row, each of which is a warning of its own
  std::set<std::string> said;         // in this row
  const auto take = [&](std::size_t row, const std::string& study, const std::string& text) {
    if (!said.insert(study + ": " + text).second) return;
    const std::string words = study + ": " + without_numbers(text);
    const auto [place, added] = known.emplace(std::pair(words, ++number[words]), all.size());
    if (added) all.push_back({study, text});
    Kept& kept = all[place->second];
    kept.rows.push_back(row);
    kept.differ = kept.differ || kept.text != text;
  };
  std::size_t variants = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    variants += !rows[r].coordinates.empty();
    number.clear();
    said.clear();
    for (const std::string& line : rows[r].unusual) take(r, {}, line);
    for (const io::StudySummary& s : rows[r].studies)
      for (const std::string& line : s.warnings) take(r, s.name, line);
  }
  constexpr std::size_t most = 6;
  std::vector<std::string> out;
  for (const Kept& k : all) {
    // The deck itself says it.
    const auto held = std::ranges::count_if(k.rows, [&](std::size_t r) { return !rows[r].coordinates.empty(); });
    if (k.study.empty() && !k.differ && std::ranges::find(given, k.text) != given.end() &&
        static_cast<std::size_t>(held) == variants)
      continue;
    std::vector<std::string> names;
    for (const std::size_t r : k.rows) names.push_back("'" + rows[r].name + "'");
    const std::size_t shown = std::min(most, names.size());
    std::string where =
        k.rows.size() == rows.size() && rows.size() > 1
            ? "all rows"
            : fmt::format("{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
    if (where != "all rows" && shown < names.size()) where += fmt::format(" and {} more", names.size() - shown);
    if (k.differ) where += fmt::format(" (numbers of {})", names.front());
    out.push_back(fmt::format("{}{}{}: {}", where, k.study.empty() ? "" : ", ", k.study, k.text));
  }
  return out;
}

void put_table(Findings& results, const std::vector<SweepRow>& rows, const std::vector<std::string>& given) {
  auto& summary = results.summary();
  for (std::string& line : warnings_of(rows, given)) summary.warnings.push_back(std::move(line));
  summary.columns = table_of(rows);
  summary.trends = trends_of(rows, summary.columns);
  std::vector<std::string> names, verdicts;
  for (const SweepRow& row : rows) {
    names.push_back(row.name);
    const VariantVerdict verdict = verdict_of(row.studies);
    verdicts.push_back(verdict.words.empty() ? name_of(verdict.found) : verdict.words);
  }
  auto& table = results.group().child("table");
  std::string order = "variant\nverdict";
  table.put("variant", names, "the deck as it stands, and the variants in their order");
  table.put("verdict", verdicts,
            "what its studies say of its stability; about an unstable equilibrium peaks, margins and factors describe "
            "no real motion");
  const auto put = [&](const std::string& name, std::vector<double> values, const std::string& unit,
                       const std::string& text) {
    table.put(io::safe_name(name), std::move(values), unit, text);
    order += "\n" + io::safe_name(name);
  };
  for (const SweepRow& row : rows)
    for (const Coordinate& c : row.coordinates) {
      if (!std::isfinite(c.value) || table.has_dataset(io::safe_name(c.quantity))) continue;
      std::vector<double> at(rows.size(), no_value);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        if (rows[k].coordinates.empty()) at[k] = c.given;
        for (const Coordinate& o : rows[k].coordinates)
          if (o.quantity == c.quantity && o.unit == c.unit) at[k] = o.value;
      }
      put(c.quantity, at, c.unit, "what changes: the value, its ratio to the deck's, or the difference");
    }
  for (const auto& c : summary.columns) {
    put(c.name, c.values, c.unit, "of the study before the first dot");
    put(c.name + " +-", c.uncertainties, c.unit, "absolute uncertainty of the column before");
  }
  // An attribute of a file holds 64 kB; without it the columns stand in the order of their names.
  if (order.size() < 60000) table.set("columns", order);
}

}  // namespace whirl::study
