#include <fmt/core.h>

#include <algorithm>

#include "study/bearing/film_at_rest.hpp"
#include "study/bearing/gas_bearing.hpp"
#include "study/brief.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {

io::Brief GasBearing::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  io::Brief brief{{capacity_words(v)}, {}};
  const std::string unit = options.speeds.front().unit;
  const std::vector<io::BriefColumn> numbers{{"load", "N"},         {"attitude", "rad"}, {"normal flow", "l/min"},
                                             {"mass flow", "kg/s"}, {"power loss", "W"}, {"Knudsen", "1"}};
  bool supplied = false;
  const auto row_of = [&](std::vector<io::BriefCell> row, const std::string& head, double knudsen) {
    for (const char* name : {"load", "attitude"}) row.emplace_back(v[head + name]);
    // A film without a supply takes nothing.
    const bool takes = v[head + "mass_flow"].value != 0;
    supplied = supplied || takes;
    for (const char* name : {"normal_flow", "mass_flow"})
      row.push_back(takes ? io::BriefCell(v[head + name]) : io::BriefCell());
    row.emplace_back(v[head + "power_loss"]);
    row.emplace_back(io::Quantity{knudsen, "1"});
    return row;
  };
  const auto knudsen_of = [&](const char* table, std::size_t k) {
    const bool known = result.group.has_group(table) && result.group.group(table).has_dataset("knudsen");
    return known ? result.group.group(table).reals("knudsen").at(k) : io::no_value;
  };
  io::BriefTable places{"Under the load", {{"speed", unit}, {"x", "m"}, {"y", "m"}, {"|e|/c", "1"}}, {}, {}};
  io::BriefTable curves{"Over the eccentricity", {{"speed", unit}, {"|e|/c", "1"}}, {}, {}};
  for (io::BriefTable* table : {&places, &curves})
    table->columns.insert(table->columns.end(), numbers.begin(), numbers.end());
  std::size_t of_equilibria = 0, of_curves = 0;
  for (const deck::Quantity& speed : options.speeds) {
    const io::Quantity shown{deck::from_si(speed.value, speed.unit), speed.unit};
    const std::string head = fmt::format("equilibrium.speed.{:.6g}.", speed.value);
    if (v.get(head + "load"))
      places.rows.push_back(row_of({shown, v[head + "x"], v[head + "y"], v[head + "eccentricity"]}, head,
                                   knudsen_of("equilibria", of_equilibria)));
    ++of_equilibria;
    for (const double e : options.eccentricities) {
      const std::string here = fmt::format("speed.{:.6g}.eccentricity.{:.6g}.", speed.value, e);
      if (v.get(here + "load"))
        curves.rows.push_back(row_of({shown, io::Quantity{e, "1"}}, here, knudsen_of("curves", of_curves)));
      ++of_curves;
    }
  }
  (curves.rows.empty() ? places : curves).note =
      std::string(supplied ? "normal flow: of the gas at 0 degC and 101325 Pa; " : "") +
      "attitude: from the load to the journal, with the rotation; Knudsen number: where the film is thinnest";
  brief.tables = {std::move(places), std::move(curves)};
  const io::Group& all = result.group;
  if (all.has_group("meshes")) {
    const io::Group& m = all.group("meshes");
    const auto around = m.reals("around"), along = m.reals("along"), rim = m.reals("load"),
               node = m.reals("load_of_node_source");
    io::BriefTable table{"Load over the mesh",
                         {{"cells"}, {"source at the rim", "N"}, {"source in a node", "N"}},
                         {},
                         "with a source in a node the load does not converge"};
    for (std::size_t k = 0; k < rim.size(); ++k)
      table.rows.push_back(
          {fmt::format("{:.0f} x {:.0f}", around[k], along[k]), io::Quantity{rim[k], "N"}, io::Quantity{node[k], "N"}});
    brief.tables.push_back(std::move(table));
  }
  if (all.has_group("map") && options.map) {
    const io::Group& m = all.group("map");
    const auto load = m.reals("load"), flow = m.reals("mass_flow"), loss = m.reals("power_loss");
    io::BriefTable table{
        fmt::format("Design map at eccentricity {}", io::reading(options.map->eccentricity)),
        {{"clearance", "m"}, {"orifice", "m"}, {"load", "N"}, {"mass flow", "kg/s"}, {"power loss", "W"}},
        {},
        {}};
    std::size_t k = 0;
    for (const deck::Quantity& c : options.map->clearances)
      for (const deck::Quantity& d : options.map->diameters) {
        table.rows.push_back({io::Quantity{c.value, "m"}, io::Quantity{d.value, "m"}, io::Quantity{load.at(k), "N"},
                              io::Quantity{flow.at(k), "kg/s"}, io::Quantity{loss.at(k), "W"}});
        ++k;
      }
    const auto best = std::ranges::max_element(load, {}, [](double x) { return x == x ? x : -1; });
    if (best != load.end() && *best == *best) {
      const auto at = static_cast<std::size_t>(best - load.begin()), each = options.map->diameters.size();
      brief.sentences.push_back(fmt::format("of the design map a clearance of {} with orifices of {} carries most, {}",
                                            io::reading({options.map->clearances[at / each].value, "m"}),
                                            io::reading({options.map->diameters[at % each].value, "m"}),
                                            io::reading({*best, "N"})));
    }
    brief.tables.push_back(std::move(table));
  }
  return brief;
}

}  // namespace whirl::study
