#include <fmt/core.h>

#include <algorithm>

#include "study/bearing/dynamic_coefficients.hpp"
#include "study/brief.hpp"

namespace whirl::study {

// A row for each speed, frequency and enforced amplitude of the summary; tilts stand in the tables.
io::Brief DynamicCoefficients::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  io::Brief brief;
  if (v.get("capacity.load"))
    brief.sentences.push_back(fmt::format("the film carries at most {}, at eccentricity {}",
                                          io::reading(v["capacity.load"]), io::reading(v["capacity.eccentricity"])));
  const std::string amplitude = ".amplitude.";
  io::BriefTable places{
      "Journal",
      {{"speed"}, {"x", "m"}, {"y", "m"}, {"|e|/c", "1"}, {"thinnest film", "m"}, {"force x", "N"}, {"force y", "N"}},
      {},
      "force of the journal on the film"};
  const std::vector<io::BriefColumn> where{{"speed"}, {"omega/Omega"}, {"amplitude"}};
  io::BriefTable k{"Stiffness of the film", where, {}, {}},
      c{"Damping of the film",
        where,
        {},
        "omega: frequency of the vibration, Omega: speed; amplitude: in clearances, 'small' by perturbation"};
  for (const char* pair : {"xx", "xy", "yx", "yy"}) {
    k.columns.push_back({std::string("K ") + pair, "N/m"});
    c.columns.push_back({std::string("C ") + pair, "N s/m"});
  }
  const auto speeds = v.between("speed.", ".eccentricity");
  for (const std::string& speed : speeds) {
    const std::string head = "speed." + speed + ".", shown = io::reading(v[head + "speed"]);
    places.rows.push_back({shown, v[head + "x"], v[head + "y"], v[head + "eccentricity"], v[head + "min_thickness"],
                           v[head + "force.x"], v[head + "force.y"]});
    const auto ratios = v.between(head + "ratio.", ".K.xx");
    const bool enforced =
        std::ranges::any_of(ratios, [&](const auto& r) { return r.find(amplitude) != std::string::npos; });
    for (const std::string& ratio : ratios) {
      const std::size_t found = ratio.find(amplitude);
      const std::string at =
          found == std::string::npos ? (enforced ? "small" : "") : ratio.substr(found + amplitude.size());
      for (auto& [table, letter] : {std::pair{&k, ".K."}, {&c, ".C."}}) {
        auto& row = table->rows.emplace_back();
        row = {shown, ratio.substr(0, found), at};
        for (const char* pair : {"xx", "xy", "yx", "yy"}) row.emplace_back(v[head + "ratio." + ratio + letter + pair]);
      }
    }
  }
  brief.tables = {std::move(k), std::move(c), std::move(places)};
  return brief;
}

}  // namespace whirl::study
