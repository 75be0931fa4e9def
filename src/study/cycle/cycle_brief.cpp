#include "study/cycle/cycle_brief.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "study/bars/beyond.hpp"
#include "study/bars/branch_brief.hpp"
#include "study/brief.hpp"

namespace whirl::study {
namespace {

constexpr const char* directions[] = {"x", "y"};

// Half the travel of one place in one direction along a branch.
struct Travel {
  std::string place;
  std::vector<double> at, half;
  std::vector<bool> stable;
};

std::vector<std::string> places_in(const io::Group& branch) {
  const auto& labels = branch.dataset("x_max").labels;
  return labels.empty() ? std::vector<std::string>() : labels.front();
}

// Of the places that are shown, then of the nodes; a branch that begins or ends at a known cycle has that one, too.
std::vector<Travel> travels(const io::Group& group, std::size_t direction) {
  std::vector<Travel> out;
  const io::Group& branch = group.group("branch");
  const std::vector<double>&at = branch.reals("parameter"), &stable = branch.reals("stable");
  const std::string d = directions[direction];
  const std::vector<std::string> names = places_in(branch);
  for (std::size_t b = 0; b < names.size(); ++b) {
    Travel& t = out.emplace_back();
    t.place = names[b];
    const auto take = [&](const io::Group& g, std::size_t row, bool is_stable) {
      const std::size_t k = row * names.size() + b;
      t.at.push_back(g.reals("parameter")[row]);
      t.half.push_back((g.reals(d + "_max")[k] - g.reals(d + "_min")[k]) / 2);
      t.stable.push_back(is_stable);
    };
    if (at.empty()) continue;
    if (group.has_group("birth")) take(group.group("birth"), 0, stable.front() > 0);
    for (std::size_t k = 0; k < at.size(); ++k) take(branch, k, stable[k] > 0);
    if (group.has_group("closing")) take(group.group("closing"), 0, stable.back() > 0);
  }
  if (!group.has_group("nodes")) return out;
  const io::Group& nodes = group.group("nodes");
  const std::vector<std::int64_t>& numbers = nodes.integers("node");
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    Travel& t = out.emplace_back();
    t.place = fmt::format("node {}", numbers[i]);
    for (std::size_t k = 0; k < std::min(at.size(), nodes.reals("parameter").size()); ++k) {
      t.at.push_back(at[k]);
      t.half.push_back(nodes.reals(d)[k * numbers.size() + i]);
      t.stable.push_back(stable[k] > 0);
    }
  }
  return out;
}

struct Largest {
  double half = -1, at = io::no_value;
};

Largest largest_of(const Travel& t, bool stable_only) {
  Largest out;
  for (std::size_t k = 0; k < t.half.size(); ++k)
    if ((t.stable[k] || !stable_only) && t.half[k] > out.half) out = {t.half[k], t.at[k]};
  return out;
}

void put_largest(io::Brief& brief, bool doubtful, const io::Group& group, const std::string& word,
                 const std::string& unit) {
  const std::vector<double>& stable = group.group("branch").reals("stable");
  if (stable.empty()) return;
  const bool any = std::ranges::any_of(stable, [](double s) { return s > 0; });
  // Where the mesh does not tell, a multiplier inside the unit circle is no proof.
  const std::string cycles = doubtful ? "the cycles that are not known to be unstable" : "the stable cycles";
  const std::string length = group.group("branch").dataset("x_max").unit;
  io::BriefTable table{
      any ? "Largest vibration of " + cycles
          : fmt::format("Largest vibration of the cycles, none of which is {}stable", doubtful ? "known to be " : ""),
      {{"place"}, {"x, 0-peak", length}, {word + " (x)", unit}, {"y, 0-peak", length}, {word + " (y)", unit}},
      {},
      "0-peak: half of the travel"};
  const std::vector<Travel> x = travels(group, 0), y = travels(group, 1);
  Largest top;
  std::string where;
  for (std::size_t p = 0; p < x.size(); ++p) {
    const Largest of[] = {largest_of(x[p], any), largest_of(y[p], any)};
    table.rows.push_back({x[p].place, io::Quantity{of[0].half, length}, io::Quantity{of[0].at, unit},
                          io::Quantity{of[1].half, length}, io::Quantity{of[1].at, unit}});
    for (std::size_t d = 0; d < 2; ++d)
      if (of[d].half > top.half) {
        top = of[d];
        where = fmt::format("in {} at {}", directions[d], x[p].place);
      }
  }
  if (any && top.half > 0)
    brief.sentences.push_back(fmt::format("The largest vibration of {} is {} 0-peak {}, reached at {}{}.", cycles,
                                          io::reading({top.half, length}), where, unit == "1" ? word + " " : "",
                                          io::reading({top.at, unit})));
  brief.tables.push_back(std::move(table));
}

// Cycles at parameters that were asked for.
io::BriefTable at_asked(const io::StudySummary& s, const std::string& word, const std::string& unit) {
  const Values v(s);
  io::BriefTable table;
  for (const std::string& key : v.between("at.", ".period")) {
    const std::string head = "at." + key + ".";
    const std::vector<std::string> places = v.between(head + "peak_to_peak.", ".x");
    for (const std::string& p : places) {
      const io::Quantity x = v[head + "peak_to_peak." + p + ".x"], y = v[head + "peak_to_peak." + p + ".y"];
      if (table.columns.empty())
        table = {"Vibration asked for, peak to peak",
                 {{word + ", place"},
                  {"x, p-p", x.unit},
                  {"y, p-p", y.unit},
                  {"thinnest film", x.unit},
                  {"largest multiplier", "1"},
                  {"period", "s"}},
                 {},
                 "multiplier: modulus of the largest Floquet multiplier; the cycle is stable below 1"};
      // One name for each row: a table that is too wide for a line repeats its first column.
      table.rows.push_back({io::reading({std::stod(key), unit}) + ", " + p, x, y, v[head + "min_thickness." + p],
                            v[head + "multiplier.modulus"], v[head + "period"]});
    }
  }
  return table;
}

// Of self-excited whirl that exists below its threshold: the unstable cycles between Hopf point and first limit point
// part small from large disturbances.
io::BriefTable safe_disturbance(const io::StudySummary& s, const io::Group& group, const std::string& word,
                                const std::string& unit) {
  const auto hopf = std::ranges::find_if(s.bifurcations, [](const io::Bifurcation& b) {
    return b.type == io::BifurcationType::hopf && b.criticality == "subcritical";
  });
  const io::Group& branch = group.group("branch");
  const std::vector<double>&at = branch.reals("parameter"), &stable = branch.reals("stable");
  if (hopf == s.bifurcations.end() || stable.empty() || stable.front() > 0) return {};
  const auto last =
      static_cast<std::size_t>(std::ranges::find_if(stable, [](double x) { return x > 0; }) - stable.begin());
  if (last < 2) return {};
  const std::vector<std::string> names = places_in(branch);
  const std::string length = branch.dataset("x_max").unit;
  io::BriefTable table{"Safe disturbance below the threshold",
                       {{word, unit}},
                       {},
                       "amplitude of the unstable whirl, 0-peak, the smaller one of x and y; the rotor comes back from "
                       "disturbances well within it, larger ones can lead to the large whirl"};
  for (const std::string& name : names) table.columns.push_back({name, length});
  const auto half = [&](const char* d, std::size_t k) {
    return (branch.reals(fmt::format("{}_max", d))[k] - branch.reals(fmt::format("{}_min", d))[k]) / 2;
  };
  for (const double share : {0.25, 0.5, 0.75, 1.0}) {
    const double wanted = hopf->value + share * (at[last - 1] - hopf->value);
    std::size_t k = 0;
    for (std::size_t i = 0; i < last; ++i)
      if (std::abs(at[i] - wanted) < std::abs(at[k] - wanted)) k = i;
    auto& row = table.rows.emplace_back();
    row.emplace_back(io::Quantity{at[k], unit});
    for (std::size_t b = 0; b < names.size(); ++b)
      row.emplace_back(
          io::Quantity{std::min(half("x", k * names.size() + b), half("y", k * names.size() + b)), length});
  }
  return table;
}

}  // namespace

io::Brief brief_of_cycles(const StudyResult& result, const CycleBranchOptions& options) {
  const bool self_excited = options.origin == CycleBranchOptions::Origin::hopf;
  std::string what = self_excited ? "limit cycle" : "forced vibration";
  if (options.period > 1) what += fmt::format(" of {} {}", options.period, self_excited ? "turns" : "revolutions");
  const io::StudySummary& s = result.summary;
  const io::Group& group = result.group;
  io::Brief brief = brief_of_branch(s, what);
  if (!group.has_group("branch")) return brief;
  const std::string word = parameter_word(options.parameter.path), unit = options.parameter.range.unit;
  const std::string end = group.has_attribute("end") ? group.text("end") : "";
  if (const io::Quantity contact = Values(s)["contact"]; std::isfinite(contact.value))
    brief.sentences.push_back(fmt::format(
        "The branch ends at {}, where {}.", io::reading(contact),
        end == "contact" ? "a journal reaches the eccentricity that counts as contact" : "a film becomes too thin"));
  else if (!end.empty() && end != "contact")
    brief.sentences.push_back(fmt::format("The branch ends where it returns to {}.", end));
  io::BriefTable open = std::move(brief.tables.back());
  brief.tables.back() = at_asked(s, word, unit);
  put_largest(brief, std::ranges::any_of(s.ranges, [](const auto& r) { return r.stability == "undetermined"; }), group,
              word, unit);
  if (self_excited) brief.tables.push_back(safe_disturbance(s, group, word, unit));
  brief.tables.push_back(std::move(open));
  return brief;
}

}  // namespace whirl::study
