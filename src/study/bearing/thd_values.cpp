#include "study/bearing/thd_results.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/columns.hpp"
#include "study/findings.hpp"

namespace whirl::study {

namespace {

bool gas(const ThdOptions& options) {
  return options.fluid.type == thermal::FluidOptions::Type::gas;
}

// Greatest difference of two pressures: of a gas over the pressure there, of a liquid over the greatest one.
double change_of(MPI_Comm comm, const std::vector<double>& a, const std::vector<double>& b, bool relative) {
  double most[2] = {};
  for (std::size_t k = 0; k < a.size(); ++k) {
    most[0] = std::max(most[0], std::abs(a[k] - b[k]) / (relative ? b[k] : 1));
    most[1] = std::max(most[1], std::abs(b[k]));
  }
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, comm);
  return relative ? most[0] : most[1] > 0 ? most[0] / most[1] : 0;
}

// Of a gas what its motion leaves is dissipation and the work of pressure; a liquid keeps the dissipation alone.
double dissipation(const ThdAtSpeed& film, const thermal::FlowReport& report) {
  return report.heat - (film.is_gas() ? report.expansion : 0);
}

}  // namespace

io::Table thd_table() {
  return io::Table(
      {{"parameter", "rad/s", "shaft speed"},
       {"power_loss", "W", "friction torque times speed"},
       {"heat", "W", "that the motion leaves in the film: of a gas dissipation and work of pressure"},
       {"dissipation", "W", "viscosity times the square of the shear rate, over the film"},
       {"expansion", "W",
        "velocity times gradient of pressure, over the film: negative where the pressure falls along the flow"},
       {"heat_bush", "W", "conducted to the bush"},
       {"heat_journal", "W", "conducted to the journal"},
       {"enthalpy", "W", "carried away through the ends, less what comes in"},
       {"residual", "W", "what the balance of the whole film leaves"},
       {"mean_temperature", "K", "of the film, by volume"},
       {"minimum_temperature", "K", "of the cells of the film"},
       {"maximum_temperature", "K", "of the cells of the film"},
       {"peak_bush_temperature", "K", "greatest temperature of the bush's surface"},
       {"mass_flow", "kg/s", "of orifices and grooves"},
       {"load_x", "N", "force of the journal on the film"},
       {"load_y", "N", "force of the journal on the film"},
       {"iterations", "1", "rounds of flow and heat"},
       {"eccentricity", "1", "of the journal, in clearances"},
       {"attitude", "rad", "direction of the journal from the bearing's middle, from +x"}});
}

void append_thd(io::Table& table, ThdAtSpeed& film, double speed) {
  thermal::ThdSolver& thd = film.thd();
  const thermal::FlowReport report = thd.flow().report(thd.flows());
  const thermal::EnergyBudget budget = thd.budget();
  const TemperatureNumbers t = temperature_numbers(film, thd.temperature());
  table.append({speed, report.power, report.heat, dissipation(film, report), report.expansion, budget.bush,
                budget.journal, budget.ends - budget.supply, budget.residual(), t.mean, t.minimum, t.maximum,
                surface_numbers(film, thd.surface(false)).maximum, report.inflow, -report.force[0], -report.force[1],
                static_cast<double>(film.cost().iterations), film.eccentricity(), film.attitude()});
}

void put_thd_values(io::StudySummary& summary, ThdAtSpeed& film, const ThdOptions& options) {
  thermal::ThdSolver& thd = film.thd();
  const thermal::FlowReport report = thd.flow().report(thd.flows());
  const thermal::EnergyBudget budget = thd.budget();
  const TemperatureNumbers t = temperature_numbers(film, thd.temperature());
  const SurfaceNumbers at_bush = surface_numbers(film, thd.surface(false)),
                       at_journal = surface_numbers(film, thd.surface(true));
  const ThdAtSpeed::Isothermal isothermal = film.isothermal();
  summary.set("load.x", -report.force[0], "N");
  summary.set("load.y", -report.force[1], "N");
  summary.set("load.isothermal.x", -isothermal.report.force[0], "N");
  summary.set("load.isothermal.y", -isothermal.report.force[1], "N");
  summary.set("max_pressure", report.highest, "Pa");
  summary.set("pressure_change",
              change_of(film.rows().comm(), thd.flow().pressure(), isothermal.pressure, gas(options)), "1");
  summary.set("mass_flow", report.inflow, "kg/s");
  summary.set("mass_flow.isothermal", isothermal.report.inflow, "kg/s");
  summary.set("power_loss", report.power, "W");
  summary.set("power_loss.isothermal", isothermal.report.power, "W");
  summary.set("heat.film", report.heat, "W");
  summary.set("heat.dissipation", dissipation(film, report), "W");
  summary.set("heat.expansion", report.expansion, "W");
  summary.set("heat.bush", budget.bush, "W");
  summary.set("heat.journal", budget.journal, "W");
  summary.set("heat.ends", budget.ends - budget.supply, "W");
  summary.set("temperature.mean", t.mean, "K");
  summary.set("temperature.minimum", t.minimum, "K");
  summary.set("temperature.maximum", t.maximum, "K");
  summary.set("temperature.percentile_1", t.percentile_1, "K");
  summary.set("temperature.percentile_99", t.percentile_99, "K");
  summary.set("temperature.bush.mean", at_bush.mean, "K");
  summary.set("temperature.bush.maximum", at_bush.maximum, "K");
  summary.set("temperature.journal.mean", at_journal.mean, "K");
  summary.set("temperature.journal.maximum", at_journal.maximum, "K");
  const std::vector<double> mixed = thd.mixed();
  for (std::size_t k = 0, m = 0; k < options.grooves.size(); ++k)
    if (options.grooves[k].mixing) summary.set(fmt::format("temperature.groove.{}", k + 1), mixed.at(m++), "K");
  if (!options.load.values.empty()) {
    summary.set("eccentricity", film.eccentricity(), "1");
    summary.set("attitude", film.attitude(), "rad");
  }
  if (options.bush.growth || options.journal.growth)
    summary.set("clearance", surface_numbers(film, film.thickness()).mean, "m");
}

std::vector<std::string> extremes_at_orifices(ThdAtSpeed& film) {
  const thermal::Rows& rows = film.rows();
  const int n = rows.mesh().nodes_around();
  std::vector<bool> beside(static_cast<std::size_t>(rows.count() * n), false);
  for (const thermal::Orifice& o : film.orifices())
    for (int j = std::max(o.j - 1, rows.begin()); j <= std::min(o.j + 1, rows.end() - 1); ++j)
      for (int i = o.i - 1; i <= o.i + 1; ++i) beside[static_cast<std::size_t>(rows.node(((i % n) + n) % n, j))] = true;
  std::vector<std::string> out;
  // `values` has as many numbers of each node as of any other; `sign` is -1 for a minimum.
  const auto add = [&](const char* name, const std::vector<double>& values, double sign) {
    double most[2] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < values.size(); ++k) {
      double& at = most[beside[k / (values.size() / beside.size())] ? 0 : 1];
      at = std::max(at, sign * values[k]);
    }
    MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, rows.comm());
    if (most[0] >= most[1]) out.emplace_back(name);
  };
  thermal::ThdSolver& thd = film.thd();
  add("max_pressure", thd.flow().pressure(), 1);
  add("temperature.minimum", thd.temperature(), -1);
  add("temperature.maximum", thd.temperature(), 1);
  add("temperature.bush.maximum", thd.surface(false), 1);
  add("temperature.journal.maximum", thd.surface(true), 1);
  const std::vector<double> isothermal = film.isothermal().pressure;
  std::vector<double> change = thd.flow().pressure();
  for (std::size_t k = 0; k < change.size(); ++k)
    change[k] = std::abs(change[k] - isothermal[k]) / (film.is_gas() ? isothermal[k] : 1);
  add("pressure_change", change, 1);
  return out;
}

namespace {

// m, what a wall of radius R does to the clearance: R a (T - T_0) where it grows freely.
double grown(const thermal::WallOptions& wall, double radius, double temperature) {
  return wall.growth ? radius * wall.expansion * (temperature - wall.reference.value_or(wall.ambient)) : 0;
}

}  // namespace

void put_properties(io::Group& group, const ThdOptions& options, const thermal::Fluid& fluid,
                    const film::Geometry& geometry) {
  if (options.temperatures.empty()) return;
  const std::vector<double> temperature = column(options.temperatures, &deck::Quantity::value);
  const auto over = [&](const auto& of) { return column(temperature, of); };
  const auto clearance = [&](double t) {
    return geometry.clearance + grown(options.bush, geometry.radius, t) - grown(options.journal, geometry.radius, t);
  };
  io::Group& table = group.child("properties");
  table.put("temperature", temperature, "K", "of fluid, bush and journal");
  table.put("clearance", over(clearance), "m", "that bush and journal leave");
  table.put("viscosity", over([&](double t) { return thermal::viscosity(fluid.viscosity, t).value; }), "Pa s",
            "dynamic");
  table.put("density", over([&](double t) { return fluid.rho(options.ambient.pressure, t); }), "kg/m^3",
            "at the pressure of the ambient");
  table.put("conductivity", over([&](double t) { return fluid.k(t); }), "W/(m K)", "of the fluid");
  table.put("heat_capacity", over([&](double t) { return fluid.c(t); }), "J/(kg K)",
            "of the fluid at constant pressure");
  table.put("prandtl", over([&](double t) { return fluid.prandtl(t); }), "1",
            "viscosity times heat capacity over conductivity");
  if (fluid.gas)
    table.put("heat_ratio", over([&](double t) { return fluid.c(t) / (fluid.c(t) - fluid.gas_constant); }), "1",
              "ratio of specific heats");
}

}  // namespace whirl::study
