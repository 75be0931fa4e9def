#include "whirl/study/bearing/thd.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/bearing/thd_film.hpp"
#include "study/bearing/thd_record.hpp"
#include "study/findings.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

// Greatest difference of two pressures: of a gas over the pressure there, of a liquid over the greatest one.
double change_of(MPI_Comm comm, const std::vector<double>& a, const std::vector<double>& b, bool gas) {
  double most[2] = {};
  for (std::size_t k = 0; k < a.size(); ++k) {
    most[0] = std::max(most[0], std::abs(a[k] - b[k]) / (gas ? b[k] : 1));
    most[1] = std::max(most[1], std::abs(b[k]));
  }
  MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, comm);
  return gas ? most[0] : most[1] > 0 ? most[0] / most[1] : 0;
}

}  // namespace

StudyResult Thd::run(Context& context) {
  const std::size_t which = options.bearing.empty() ? 0 : *system::find_bearing(context.machine, options.bearing);
  const film::Geometry& geometry = *context.machine.bearings[which].geometry;
  auto& results = context.results;
  auto& summary = results.summary();
  io::Group& group = results.group();
  group.set("bearing", context.machine.bearings[which].name);
  group.set("parameter", "speed");
  group.set("parameter_unit", "rad/s");

  std::vector<double> speeds, losses, dissipation, bush, journal, ends, residuals, means, peaks;
  std::vector<std::string> unsettled;
  for (const deck::Quantity& speed : options.speeds) {
    results.progress(fmt::format("speed {:.6g} rad/s", speed.value));
    ThdFilm film(context.comm, options, geometry, speed.value);
    const thermal::ThdSolve cost = film.thd().solve();
    if (!cost.converged) unsettled.push_back(fmt::format("{:.6g} rad/s", speed.value));
    const thermal::FlowReport report = film.thd().flow().report(film.thd().flows());
    const thermal::EnergyBudget budget = film.thd().budget();
    const TemperatureNumbers t = temperature_numbers(film, film.thd().temperature());
    speeds.push_back(speed.value);
    losses.push_back(report.power);
    dissipation.push_back(report.heat);
    bush.push_back(budget.bush);
    journal.push_back(budget.journal);
    ends.push_back(budget.ends - budget.supply);
    residuals.push_back(budget.residual());
    means.push_back(t.mean);
    const SurfaceNumbers at_bush = surface_numbers(film, film.thd().bush_surface()),
                         at_journal = surface_numbers(film, film.thd().journal_surface());
    peaks.push_back(at_bush.maximum);
    if (&speed != &options.speeds.back()) continue;
    const ThdFilm::Isothermal isothermal = film.isothermal();
    summary.set("load.x", -report.force[0], "N");
    summary.set("load.y", -report.force[1], "N");
    summary.set("load.isothermal.x", -isothermal.report.force[0], "N");
    summary.set("load.isothermal.y", -isothermal.report.force[1], "N");
    summary.set("max_pressure", report.highest, "Pa");
    const bool gas = options.fluid.type == thermal::FluidOptions::Type::gas;
    summary.set("pressure_change", change_of(context.comm, film.thd().flow().pressure(), isothermal.pressure, gas),
                "1");
    summary.set("mass_flow", report.inflow, "kg/s");
    summary.set("mass_flow.isothermal", isothermal.report.inflow, "kg/s");
    summary.set("power_loss", report.power, "W");
    summary.set("power_loss.isothermal", isothermal.report.power, "W");
    summary.set("heat.film", report.heat, "W");
    summary.set("heat.bush", budget.bush, "W");
    summary.set("heat.journal", budget.journal, "W");
    summary.set("heat.ends", budget.ends - budget.supply, "W");
    summary.set("energy_residual", budget.residual(), "W");
    summary.set("temperature.mean", t.mean, "K");
    summary.set("temperature.minimum", t.minimum, "K");
    summary.set("temperature.maximum", t.maximum, "K");
    summary.set("temperature.percentile_1", t.percentile_1, "K");
    summary.set("temperature.percentile_99", t.percentile_99, "K");
    summary.set("temperature.bush.mean", at_bush.mean, "K");
    summary.set("temperature.bush.maximum", at_bush.maximum, "K");
    summary.set("temperature.journal.mean", at_journal.mean, "K");
    summary.set("temperature.journal.maximum", at_journal.maximum, "K");
    summary.set("iterations", cost.iterations, "1");
    summary.set("iterations.pressure", cost.pressure, "1");
    summary.set("iterations.energy_newton", cost.energy_newton, "1");
    summary.set("iterations.energy_krylov", cost.energy_krylov, "1");
    auto& rounds = group.child("iterations");
    rounds.put("field", std::vector<std::string>{"temperature"}, "what the residual is of");
    rounds.put("residual", io::Shape{cost.largest.size(), 1}, cost.largest, "K",
               "greatest change of a temperature in each round [iteration][field]");
    put_thd_fields(context, film, geometry);
  }
  auto& table = group.child("budget");
  table.put("parameter", speeds, "rad/s", "shaft speed");
  table.put("power_loss", losses, "W", "friction torque times speed");
  table.put("heat", dissipation, "W", "that the motion leaves in the film: of a gas dissipation and work of pressure");
  table.put("heat_bush", bush, "W", "conducted to the bush");
  table.put("heat_journal", journal, "W", "conducted to the journal");
  table.put("enthalpy", ends, "W", "carried away through the ends, less what comes in");
  table.put("residual", residuals, "W", "what the balance of the whole film leaves");
  table.put("mean_temperature", means, "K", "of the film, by volume");
  table.put("peak_bush_temperature", peaks, "K", "greatest temperature of the bush's surface");
  summary.points = static_cast<long>(speeds.size());
  if (!unsettled.empty())
    return results.finish(fmt::format("temperatures did not settle within {} iterations at {}", options.most_iterations,
                                      fmt::join(unsettled, ", ")),
                          true);
  return results.finish("completed", true);
}

}  // namespace whirl::study
