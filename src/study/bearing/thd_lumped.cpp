#include "study/bearing/thd_lumped.hpp"

#include <algorithm>
#include <numbers>

#include "study/bearing/thd_record.hpp"
#include "whirl/core/error.hpp"
#include "whirl/thermal/lumped.hpp"

namespace whirl::study {

void put_lumped(io::StudySummary& summary, ThdAtSpeed& film, const ThdOptions& options,
                const film::Geometry& geometry) {
  if (film.is_gas()) return;
  thermal::ThdSolver& thd = film.thd();
  const double area = 2 * std::numbers::pi * geometry.radius * geometry.length;
  const auto wall = [&](const thermal::WallOptions& side, const std::vector<double>& surface) {
    const bool adiabatic = side.type == thermal::WallOptions::Type::adiabatic;
    return thermal::LumpedWall{adiabatic ? 0 : area, surface_numbers(film, surface).mean};
  };
  const std::array<thermal::LumpedWall, 2> walls{wall(options.bush, thd.surface(false)),
                                                 wall(options.journal, thd.surface(true))};
  ThdAtSpeed::Isothermal at;
  std::vector<double> pressure;
  const auto told = [&](double temperature) {
    at = film.isothermal(temperature, pressure);
    return thermal::LumpedFilm{at.drawn, at.inlet, at.report.heat};
  };
  double start = options.ambient.temperature;
  for (const thermal::SupplyGroove& groove : options.grooves) start = std::min(start, groove.temperature);
  for (const thermal::LumpedWall& w : walls)
    if (w.area > 0) start = std::min(start, w.temperature);
  try {
    const double temperature = thermal::lumped_temperature(film.fluid(), geometry.clearance, walls, told, start);
    (void)told(temperature);
    summary.set("temperature.lumped", temperature, "K");
    summary.set("load.lumped.x", -at.report.force[0], "N");
    summary.set("load.lumped.y", -at.report.force[1], "N");
    summary.set("power_loss.lumped", at.report.power, "W");
    summary.set("mass_flow.lumped", at.drawn, "kg/s");
  } catch (const core::DomainError& error) {
    summary.warnings.push_back(error.what());
  } catch (const core::NotConverged& error) {
    summary.warnings.push_back(error.what());
  }
}

}  // namespace whirl::study
