#include <fmt/core.h>

#include <algorithm>

#include "study/bearing/bearing_map.hpp"
#include "study/brief.hpp"

namespace whirl::study {
namespace {

// Ten of so many points, the last one with them.
std::vector<std::size_t> shown_of(std::size_t count) {
  constexpr std::size_t most = 10;
  std::vector<std::size_t> out;
  const std::size_t step = std::max<std::size_t>(1, (count + most - 1) / most);
  for (std::size_t k = count > 0 ? (count - 1) % step : 0; k < count; k += step) out.push_back(k);
  return out;
}

// A value of a table with the bar that stands beside it.
io::Quantity with_bar_of(const io::Group& g, const std::string& name, std::size_t row, const char* unit) {
  io::Quantity q{g.reals(name)[row], unit};
  const std::string bar = name + "_uncertainty";
  if (g.has_dataset(bar) && g.reals(bar)[row] > 0) q.more["uncertainty"] = g.reals(bar)[row];
  return q;
}

}  // namespace

io::Brief BearingMap::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  io::Brief brief;
  if (v.get("threshold.speed"))
    brief.sentences.push_back(
        fmt::format("the rotor of the deck, taken as rigid, is stable up to {} (eccentricity {}), and whirls at {} of "
                    "the speed there",
                    io::reading(v["threshold.speed"]), io::reading(v["threshold.eccentricity"].value),
                    io::reading(v["threshold.whirl_ratio"].value)));
  const std::vector<io::BriefColumn> numbers{
      {"|e|/c", "1"}, {"attitude", "rad"}, {"speed limit", "1"}, {"whirl ratio", "1"}};
  const char* const note = "S = (c/R)^2 load/(mu Omega L D); speed limit: Omega sqrt(m c/load) of a rigid rotor";
  io::BriefTable loads{"At the loads asked for", {{"Sommerfeld S"}}, {}, note};
  io::BriefTable locus{"Locus of the journal", {{"Sommerfeld S", "1"}}, {}, note};
  for (io::BriefTable* table : {&loads, &locus})
    table->columns.insert(table->columns.end(), numbers.begin(), numbers.end());
  for (const std::string& load : v.between("sommerfeld.", ".eccentricity")) {
    const std::string head = "sommerfeld." + load + ".";
    loads.rows.push_back(
        {load, v[head + "eccentricity"], v[head + "attitude"], v[head + "speed_limit"], v[head + "whirl_ratio"]});
  }
  // Ten of the points, the last one with them.
  if (result.group.has_group("locus")) {
    const io::Group& g = result.group.group("locus");
    for (const std::size_t k : shown_of(g.reals("eccentricity").size()))
      locus.rows.push_back({with_bar_of(g, "sommerfeld", k, "1"), with_bar_of(g, "eccentricity", k, "1"),
                            with_bar_of(g, "attitude", k, "rad"), with_bar_of(g, "speed_limit", k, "1"),
                            with_bar_of(g, "whirl_ratio", k, "1")});
  }
  io::BriefTable coefficients{"Stiffness and damping along the locus, nondimensional",
                              {{"|e|/c", "1"}},
                              {},
                              "k = c K/(load/S), b = c Omega C/(load/S); S as above"};
  constexpr const char* pairs[] = {"xx", "xy", "yx", "yy"};
  for (const char* letter : {"k", "b"})
    for (const char* pair : pairs) coefficients.columns.push_back({fmt::format("{} {}", letter, pair), "1"});
  if (result.group.has_group("locus")) {
    const io::Group& g = result.group.group("locus");
    const std::vector<double>& e = g.reals("eccentricity");
    for (const std::size_t k : shown_of(e.size())) {
      auto& row = coefficients.rows.emplace_back();
      row.emplace_back(io::Quantity{e[k], "1"});
      for (const char* letter : {"k", "c"})
        for (const char* pair : pairs) row.emplace_back(with_bar_of(g, fmt::format("{}_{}", letter, pair), k, "1"));
    }
  }
  brief.tables = {std::move(loads), std::move(locus), std::move(coefficients)};
  return brief;
}

}  // namespace whirl::study
