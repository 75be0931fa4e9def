#include <fmt/core.h>

#include <cmath>

#include "study/bearing/thd_study.hpp"
#include "study/brief.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

io::Quantity watts(double value) {
  return {value, "W"};
}

// Speed by speed; the rest is that of the last one.
io::BriefTable over_speed(const io::Group& budget, const std::string& unit) {
  io::BriefTable table{"Over the speed",
                       {{"speed", unit},
                        {"power loss", "W"},
                        {"mean film", "degC"},
                        {"hottest film", "degC"},
                        {"to bush", "W"},
                        {"to journal", "W"},
                        {"carried off", "W"},
                        {"|e|/c", "1"}},
                       {},
                       {}};
  const auto column = [&](const char* name) { return budget.reals(name); };
  const std::vector<double> speed = column("parameter"), loss = column("power_loss"), mean = column("mean_temperature"),
                            hottest = column("maximum_temperature"), bush = column("heat_bush"),
                            journal = column("heat_journal"), ends = column("enthalpy"), place = column("eccentricity");
  for (std::size_t k = 0; k < speed.size(); ++k)
    table.rows.push_back({io::Quantity{deck::from_si(speed[k], unit), unit}, watts(loss[k]), in_celsius({mean[k], "K"}),
                          in_celsius({hottest[k], "K"}), watts(bush[k]), watts(journal[k]), watts(ends[k]),
                          io::Quantity{place[k], "1"}});
  return table;
}

// Clearance and properties of the fluid, bush and journal as warm as it.
io::BriefTable over_temperature(const io::Group& properties) {
  io::BriefTable table{"Clearance and fluid over the temperature",
                       {{"temperature", "degC"},
                        {"clearance", "m"},
                        {"viscosity", "Pa s"},
                        {"density", "kg/m^3"},
                        {"conductivity", "W/(m K)"},
                        {"heat capacity", "J/(kg K)"}},
                       {},
                       "bush, journal and fluid have one temperature; density at the pressure of the ambient"};
  const std::vector<double>& temperature = properties.reals("temperature");
  constexpr std::pair<const char*, const char*> columns[] = {{"clearance", "m"},
                                                             {"viscosity", "Pa s"},
                                                             {"density", "kg/m^3"},
                                                             {"conductivity", "W/(m K)"},
                                                             {"heat_capacity", "J/(kg K)"}};
  for (std::size_t k = 0; k < temperature.size(); ++k) {
    auto& row = table.rows.emplace_back();
    row.emplace_back(in_celsius({temperature[k], "K"}));
    for (const auto& [name, unit] : columns) row.emplace_back(io::Quantity{properties.reals(name)[k], unit});
  }
  return table;
}

// Of a column from the first row to the last, in percent.
double change_of(const std::vector<std::vector<io::BriefCell>>& rows, std::size_t column) {
  return 100 * (rows.back()[column].quantity.value / rows.front()[column].quantity.value - 1);
}

}  // namespace

io::Brief ThdStudy::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  io::Brief brief;
  if (!v.get("power_loss")) return brief;
  const deck::Quantity& speed = options.speeds.back();
  const std::string at = io::reading({deck::from_si(speed.value, speed.unit), speed.unit});
  brief.sentences.push_back(
      fmt::format("at {} the power loss is {}, the film has {} in the mean and {} where it is hottest", at,
                  io::reading(v["power_loss"]), io::reading(in_celsius(v["temperature.mean"])),
                  io::reading(in_celsius(v["temperature.maximum"]))));
  if (const auto c = v.get("clearance"))
    brief.sentences.push_back(
        fmt::format("with the thermal expansion the clearance is {}", io::reading(v["clearance"])));
  io::BriefTable film{"Film at " + at,
                      {{"film"},
                       {"load x", "N"},
                       {"load y", "N"},
                       {"power loss", "W"},
                       {"mass flow", "kg/s"},
                       {"place |e|/c", "1"},
                       {"attitude", "rad"}},
                      {},
                      "load that the film carries, along x and y"};
  // A component that symmetry makes zero is rounding.
  const auto load_of = [&](const char* head, const char* axis) {
    io::Quantity q = v[std::string(head) + axis];
    if (std::abs(q.value) < 1e-9 * std::hypot(v[std::string(head) + "x"].value, v[std::string(head) + "y"].value))
      q = {0, "N"};
    return q;
  };
  film.rows.push_back({"with its heat", load_of("load.", "x"), load_of("load.", "y"), v["power_loss"], v["mass_flow"],
                       v["eccentricity"], v["attitude"]});
  film.rows.push_back({"isothermal",
                       load_of("load.isothermal.", "x"),
                       load_of("load.isothermal.", "y"),
                       v["power_loss.isothermal"],
                       v["mass_flow.isothermal"],
                       {},
                       {}});
  if (v.get("load.lumped.x"))
    film.rows.push_back({"one temperature",
                         load_of("load.lumped.", "x"),
                         load_of("load.lumped.", "y"),
                         v["power_loss.lumped"],
                         v["mass_flow.lumped"],
                         {},
                         {}});
  io::BriefTable warm{
      "Temperatures at " + at, {{"of"}, {"mean", "degC"}, {"lowest", "degC"}, {"highest", "degC"}}, {}, {}};
  const auto celsius = [&](const std::string& name) { return in_celsius(v["temperature." + name]); };
  warm.rows.push_back({"film", celsius("mean"), celsius("minimum"), celsius("maximum")});
  for (const char* solid : {"bush", "journal"})
    warm.rows.push_back({solid, celsius(std::string(solid) + ".mean"), {}, celsius(std::string(solid) + ".maximum")});
  for (const std::string& groove : v.between("temperature.groove.", ""))
    warm.rows.push_back({"groove " + groove + ", mixed", celsius("groove." + groove), {}, {}});
  io::BriefTable heat{"Heat at " + at,
                      {{"heat"}, {"flow", "W"}},
                      {},
                      "dissipation and work of the pressure make what bush, journal and flow take away"};
  for (const auto& [name, words] : {std::pair{"dissipation", "dissipated"},
                                    {"expansion", "work of the pressure"},
                                    {"bush", "to the bush"},
                                    {"journal", "to the journal"},
                                    {"ends", "carried off by the flow"}})
    heat.rows.push_back({words, v[std::string("heat.") + name]});
  brief.tables = {std::move(film), std::move(warm), std::move(heat)};
  if (options.speeds.size() > 1 && result.group.has_group("budget"))
    brief.tables.push_back(over_speed(result.group.group("budget"), speed.unit));
  if (result.group.has_group("properties")) {
    brief.tables.push_back(over_temperature(result.group.group("properties")));
    if (const auto& rows = brief.tables.back().rows; rows.size() > 1)
      brief.sentences.push_back(
          fmt::format("from {} to {} the clearance changes by {:+.0f} %, the viscosity by {:+.0f} %, "
                      "the density by {:+.0f} %",
                      io::reading(rows.front()[0].quantity), io::reading(rows.back()[0].quantity), change_of(rows, 1),
                      change_of(rows, 2), change_of(rows, 3)));
  }
  return brief;
}

}  // namespace whirl::study
