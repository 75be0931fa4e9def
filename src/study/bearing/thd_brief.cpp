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
  film.rows.push_back(
      {"with its heat", v["load.x"], v["load.y"], v["power_loss"], v["mass_flow"], v["eccentricity"], v["attitude"]});
  film.rows.push_back({"isothermal",
                       v["load.isothermal.x"],
                       v["load.isothermal.y"],
                       v["power_loss.isothermal"],
                       v["mass_flow.isothermal"],
                       {},
                       {}});
  if (v.get("load.lumped.x"))
    film.rows.push_back({"one temperature",
                         v["load.lumped.x"],
                         v["load.lumped.y"],
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
  return brief;
}

}  // namespace whirl::study
