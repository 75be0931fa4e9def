#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "study/bearing/dynamic_coefficients.hpp"
#include "study/bearing/film_at_rest.hpp"
#include "study/brief.hpp"
#include "study/evenly.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

constexpr const char* shifts[] = {"xx", "xy", "yx", "yy"};
constexpr const char* slopes[] = {"slope_x.slope_x", "slope_x.slope_y", "slope_y.slope_x", "slope_y.slope_y"};
constexpr const char* mixed[] = {"x.slope_x", "x.slope_y", "y.slope_x", "y.slope_y",
                                 "slope_x.x", "slope_x.y", "slope_y.x", "slope_y.y"};

const std::string of_amplitude = ".amplitude.";

// A speed, a frequency and an enforced amplitude of the summary: `head` of its values, and the cells that name it.
struct CoefficientRow {
  std::string head;
  std::vector<io::BriefCell> cells;
  bool enforced = false;
};

std::vector<CoefficientRow> coefficient_rows(const Values& v) {
  std::vector<CoefficientRow> out;
  for (const std::string& speed : v.between("speed.", ".eccentricity")) {
    const std::string head = "speed." + speed + ".", shown = io::reading(v[head + "speed"]);
    const auto ratios = v.between(head + "ratio.", ".K.xx");
    const bool compared =
        std::ranges::any_of(ratios, [](const auto& r) { return r.find(of_amplitude) != std::string::npos; });
    for (const std::string& ratio : ratios) {
      const std::size_t found = ratio.find(of_amplitude);
      const bool enforced = found != std::string::npos;
      out.push_back({head + "ratio." + ratio + ".",
                     {shown, ratio.substr(0, found),
                      enforced   ? ratio.substr(found + of_amplitude.size())
                      : compared ? "small"
                                 : ""},
                     enforced});
    }
  }
  return out;
}

const std::vector<io::BriefColumn> keys_of_rows{{"speed"}, {"omega/Omega"}, {"amplitude"}};

io::BriefTable matrix(const Values& v, const std::vector<CoefficientRow>& places, const std::string& caption,
                      char letter, bool of_slopes) {
  io::BriefTable out{caption, keys_of_rows, {}, {}};
  const bool stiff = letter == 'K';
  for (std::size_t p = 0; p < 4; ++p) {
    const char* const pair = shifts[p];
    out.columns.push_back(
        {of_slopes ? fmt::format("{} {}'{}'", letter, pair[0], pair[1]) : fmt::format("{} {}", letter, pair),
         of_slopes ? (stiff ? "N m" : "N m s") : (stiff ? "N/m" : "N s/m")});
  }
  for (const CoefficientRow& at : places) {
    auto& row = out.rows.emplace_back(at.cells);
    for (std::size_t p = 0; p < 4; ++p)
      row.emplace_back(v[fmt::format("{}{}.{}", at.head, letter, of_slopes ? slopes[p] : shifts[p])]);
  }
  return out;
}

// Whether tilts make forces and shifts moments, beside rounding.
std::string of_coupling(const Values& v, const std::vector<CoefficientRow>& places) {
  constexpr double rounding = 1e-9;
  double coupling = 0, own = 0;
  for (const CoefficientRow& at : places) {
    for (const char* pair : mixed) coupling = std::max(coupling, std::abs(v[at.head + "K." + pair].value));
    own = std::max(own, std::sqrt(std::abs(v[at.head + "K.xx"].value * v[at.head + "K.slope_x.slope_x"].value)));
  }
  if (!(own > 0)) return {};
  return coupling <= rounding * own
             ? "tilts of the journal make no force, and shifts no moment"
             : fmt::format(
                   "a tilt also makes a force, and a shift a moment: at most {} for a slope of 1 (table "
                   "'coefficients')",
                   io::reading({coupling, "N"}));
}

// What a vibration of finite amplitude differs by from a small one.
io::BriefTable against_linear(const Values& v, const std::vector<CoefficientRow>& places) {
  io::BriefTable out{"Motion of finite amplitude",
                     keys_of_rows,
                     {},
                     "distortion: the part of the force that the fitted K and C do not explain (ratio of root mean "
                     "squares), for motion along x and along y; difference: the largest change of K and C against a "
                     "small vibration"};
  out.columns.insert(out.columns.end(), {{"distortion x", "%"}, {"distortion y", "%"}, {"difference", "%"}});
  for (const CoefficientRow& at : places) {
    if (!at.enforced) continue;
    auto& row = out.rows.emplace_back(at.cells);
    for (const char* name : {"distortion.x", "distortion.y", "from_perturbation"})
      row.emplace_back(scaled(v[at.head + name], 100, "%"));
  }
  return out;
}

// Some of the frequencies of a range, its ends among them.
io::BriefTable over_frequency(const io::Group& group, const std::vector<deck::Quantity>& speeds, std::size_t alone) {
  constexpr std::size_t most = 7;
  io::BriefTable out{"Over the frequency", {{"speed"}, {"omega/Omega"}}, {}, {}};
  if (!group.has_group("coefficients")) return out;
  const io::Group& g = group.group("coefficients");
  const auto& ratio = g.reals("ratio");
  if (ratio.size() <= alone + 1) return out;
  const std::pair<const char*, const char*> columns[] = {
      {"k_xx", "N/m"}, {"k_yy", "N/m"}, {"c_xx", "N s/m"}, {"c_yy", "N s/m"}};
  for (const auto& [name, unit] : columns)
    out.columns.push_back({fmt::format("{} {}", name[0] == 'k' ? 'K' : 'C', name + 2), unit});
  for (std::size_t s = 0; s < speeds.size(); ++s)
    for (const std::size_t shown : few_of(ratio.size() - alone, most)) {
      const std::size_t f = alone + shown, at = s * ratio.size() + f;
      if (std::isnan(g.reals("k_xx")[at])) continue;  // no equilibrium
      auto& row = out.rows.emplace_back();
      row = {io::reading({deck::from_si(speeds[s].value, speeds[s].unit), speeds[s].unit}),
             fmt::format("{:.3g}", ratio[f])};
      for (const auto& [name, unit] : columns) {
        io::Quantity q{g.reals(name)[at], unit};
        const std::string bar = std::string(name) + "_uncertainty";
        if (g.has_dataset(bar) && g.reals(bar)[at] > 0) q.more["uncertainty"] = g.reals(bar)[at];
        row.emplace_back(std::move(q));
      }
    }
  return out;
}

// Equilibrium has no force across the load; what is left of it is rounding.
io::BriefCell force_of(const io::Quantity& part, const io::Quantity& other) {
  constexpr double rounding = 1e-9, least = 1e-9;  // of the other one; N
  return std::abs(part.value) <= std::max(least, rounding * std::abs(other.value)) ? io::BriefCell()
                                                                                   : io::BriefCell(part);
}

}  // namespace

io::Brief DynamicCoefficients::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  const std::vector<CoefficientRow> places = coefficient_rows(v);
  io::Brief brief{{capacity_words(v), of_coupling(v, places)}, {}};
  io::BriefTable journal{
      "Journal",
      {{"speed"}, {"x", "m"}, {"y", "m"}, {"|e|/c", "1"}, {"thinnest film", "m"}, {"force x", "N"}, {"force y", "N"}},
      {},
      "force of the film on the journal"};
  for (const std::string& speed : v.between("speed.", ".eccentricity")) {
    const std::string head = "speed." + speed + ".";
    const io::Quantity x = v[head + "force.x"], y = v[head + "force.y"];
    journal.rows.push_back({io::reading(v[head + "speed"]), v[head + "x"], v[head + "y"], v[head + "eccentricity"],
                            v[head + "min_thickness"], force_of(x, y), force_of(y, x)});
  }
  brief.tables = {matrix(v, places, "Stiffness of the film", 'K', false),
                  matrix(v, places, "Damping of the film", 'C', false)};
  brief.tables.back().note = "omega: frequency of the vibration, Omega: speed";
  if (std::ranges::any_of(places, &CoefficientRow::enforced))
    brief.tables.back().note += "; amplitude: in clearances, 'small' by perturbation";
  if (!v.between("speed.", ".K.slope_x.slope_x").empty()) {
    brief.tables.push_back(matrix(v, places, "Stiffness of the film against tilt", 'K', true));
    brief.tables.push_back(matrix(v, places, "Damping of the film against tilt", 'C', true));
    brief.tables.back().note = "x', y': slopes dx/dz and dy/dz of the journal, and the moments that do work with them";
  }
  brief.tables.push_back(against_linear(v, places));
  brief.tables.push_back(over_frequency(result.group, options.speeds, options.frequencies.size()));
  brief.tables.push_back(std::move(journal));
  return brief;
}

}  // namespace whirl::study
