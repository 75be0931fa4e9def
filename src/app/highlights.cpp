#include "highlights.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "whirl/study/sweep/verdict_words.hpp"

namespace whirl::app {
namespace {

// What the studies of the rows say of stability: the deck as given, whose studies stand `before` the sweep, and the
// variants.
std::vector<study::VariantVerdict> verdicts_of(const io::StudySummary& s, std::size_t given,
                                               std::span<const io::StudySummary> before) {
  std::vector<study::VariantVerdict> out;
  if (given > 0) {
    std::vector<io::StudySummary> own;
    for (const io::StudySummary& b : before)
      if (std::ranges::any_of(s.variants.front().studies, [&](const auto& v) { return v.name == b.name; }))
        own.push_back(b);
    out.push_back(study::verdict_of(own));
  }
  for (const io::VariantSummary& v : s.variants) out.push_back(study::verdict_of(v.studies));
  return out;
}

// Variants down, their verdicts and values across, those with bars first; the rest is in the tables. Below them what is
// not stable, in words.
std::string of_sweep(const io::StudySummary& s, std::span<const io::StudySummary> before) {
  constexpr std::size_t most = 6, most_told = 12;
  std::vector<const io::SweepColumn*> columns;
  for (const io::SweepColumn& c : s.columns) columns.push_back(&c);
  const auto has_bar = [](const io::SweepColumn* c) {
    return std::any_of(c->uncertainties.begin(), c->uncertainties.end(), [](double u) { return u > 0; });
  };
  std::stable_partition(columns.begin(), columns.end(), has_bar);
  const std::size_t shown = std::min(most, columns.size());
  std::vector<std::string> heads{"variant", "verdict"};
  for (std::size_t c = 0; c < shown; ++c) {
    const bool bare = columns[c]->unit.empty() || columns[c]->unit == "1";
    heads.push_back(columns[c]->name + (bare ? "" : " [" + columns[c]->unit + "]"));
  }
  Grid grid(heads);
  // The columns begin with the deck as given if the sweep counts it.
  const std::size_t rows = columns.empty() ? s.variants.size() : columns.front()->values.size(),
                    given = rows - s.variants.size();
  const std::vector<study::VariantVerdict> verdicts = verdicts_of(s, given, before);
  std::vector<std::string> told;
  bool any_marked = false;
  for (std::size_t i = 0; i < rows; ++i) {
    const std::string& name = i < given ? "as given" : s.variants[i - given].name;
    const study::VariantVerdict& verdict = verdicts[i];
    // A wide table is printed in several blocks: the name repeats in each, and the mark with it.
    const bool marked = verdict.found > study::Found::stable;
    any_marked = any_marked || marked;
    if (marked && verdict.words != "unstable") told.push_back(name + ": " + verdict.words);
    std::vector<std::string> row{name + (marked ? " *" : ""), study::name_of(verdict.found)};
    for (std::size_t c = 0; c < shown; ++c) {
      const double value = columns[c]->values[i];
      row.push_back(std::isfinite(value) ? with_uncertainty(value, columns[c]->uncertainties[i], "") : "-");
    }
    grid.add(std::move(row));
  }
  std::string out = grid.text();
  if (shown < columns.size())
    out += fmt::format("    and {} more values: see the report or the CSV table\n", columns.size() - shown);
  if (any_marked)
    out += in_lines(
        "*: not known to be stable. About an unstable equilibrium peaks, margins and factors describe no real motion.",
        4);
  for (std::size_t k = 0; k < std::min(most_told, told.size()); ++k) out += in_lines(told[k], 4);
  if (told.size() > most_told)
    out += fmt::format("    and {} more: see 'verdict' in the table\n", told.size() - most_told);
  return out;
}

}  // namespace

std::string highlights(const io::StudySummary& s, std::span<const io::StudySummary> before) {
  const Values v(s);
  if (s.kind == "equilibrium_branch") return of_equilibria(s, v);
  if (s.kind == "cycle_branch") return of_cycles(s, v);
  if (s.kind == "run_up") return of_run_up(s, v);
  if (s.kind == "motion") return of_motion(s, v);
  if (s.kind == "frequency_response") return of_transfers(s, v);
  if (s.kind == "sweep") return of_sweep(s, before);
  return {};
}

}  // namespace whirl::app
