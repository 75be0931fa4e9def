#include "study/bearing/thd_results.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include "study/bars/summary_bars.hpp"
#include "whirl/core/error.hpp"
#include "whirl/thermal/lumped.hpp"

namespace whirl::study {

namespace {

struct Quantity {
  const char *key, *text;
};
constexpr std::array<Quantity, 3> held{{{"load", "load"}, {"power_loss", "power loss"}, {"mass_flow", "flow"}}};
using HeldValues = std::array<double, held.size()>;

// N, W, kg/s.
HeldValues values_of(const thermal::FlowReport& report) {
  return {std::hypot(report.force[0], report.force[1]), report.power, report.inflow};
}

// Angle from one force to another, rad.
double turn_between(const double (&from)[2], const double (&to)[2]) {
  return std::atan2(from[0] * to[1] - from[1] * to[0], from[0] * to[0] + from[1] * to[1]);
}

// Where f changes its sign between a and b, to 1e-6 K, by the method of false position with Illinois' weights
// (Dowell and Jarratt 1971); nothing where it has one sign at both.
std::optional<double> zero(const std::function<double(double)>& f, double a, double b) {
  double fa = f(a), fb = f(b);
  if (fa * fb > 0 || fa == fb) return {};
  double x = fa == 0 ? a : b;
  for (int k = 0; k < 60 && fa != 0 && fb != 0; ++k) {
    const double before = x;
    x = (a * fb - b * fa) / (fb - fa);
    const double fx = f(x);
    if (fx * fb < 0) {
      a = b;
      fa = fb;
    } else {
      fa /= 2;
    }
    b = x;
    fb = fx;
    if (fx == 0 || std::abs(x - before) < 1e-6) return x;
  }
  return x;
}

}  // namespace

void put_effective(io::Group& group, io::StudySummary& summary, ThdAtSpeed& film, double ambient) {
  thermal::ThdSolver& thd = film.thd();
  const thermal::FlowReport wanted_report = thd.flow().report(thd.flows());
  const HeldValues wanted = values_of(wanted_report);
  const TemperatureNumbers t = temperature_numbers(film, thd.temperature());
  std::vector<double> pressure;
  const auto at = [&](double temperature) { return film.isothermal(temperature, pressure, true).report; };
  const double span = std::max({t.maximum - t.minimum, std::abs(t.mean - ambient), 1.0});
  const double low = t.minimum - std::min(span, t.minimum / 4), high = t.maximum + span;

  std::vector<std::string> names;
  std::vector<double> temperatures, angles;
  std::array<std::vector<double>, held.size()> errors;
  for (std::size_t q = 0; q < held.size(); ++q) {
    if (wanted[q] <= 0) continue;
    try {
      const auto off = [&](double temperature) { return values_of(at(temperature))[q] / wanted[q] - 1; };
      const std::optional<double> found = zero(off, low, high);
      if (!found) {
        summary.warnings.push_back(
            fmt::format("no film of one temperature between {:.5g} and {:.5g} K has the {} of the film with heat", low,
                        high, held[q].text));
        continue;
      }
      const thermal::FlowReport report = at(*found);
      const HeldValues values = values_of(report);
      summary.set(fmt::format("temperature.effective.{}", held[q].key), *found, "K");
      names.emplace_back(held[q].key);
      temperatures.push_back(*found);
      angles.push_back(turn_between(wanted_report.force, report.force));
      for (std::size_t k = 0; k < held.size(); ++k)
        errors[k].push_back(wanted[k] > 0 ? values[k] / wanted[k] - 1 : std::numeric_limits<double>::quiet_NaN());
      if (q != 0) continue;
      summary.set("effective.load_angle_error", angles.back(), "rad");
      for (std::size_t k = 1; k < held.size(); ++k)
        if (wanted[k] > 0) summary.set(fmt::format("effective.{}_error", held[k].key), errors[k].back(), "1");
    } catch (const core::NotConverged& error) {
      summary.warnings.push_back(error.what());
    } catch (const core::DomainError& error) {
      summary.warnings.push_back(error.what());
    }
  }
  if (names.empty()) return;
  io::Group& table = group.child("effective");
  table.put("same", names, "what the film of one temperature has in common with the film with heat");
  table.put("temperature", temperatures, "K", "of that film");
  table.put("load_angle_error", angles, "rad", "from the force of the film with heat to that film's");
  for (std::size_t k = 0; k < held.size(); ++k)
    table.put(fmt::format("{}_error", held[k].key), errors[k], "1",
              fmt::format("relative error of its {}", held[k].text));
}

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
  std::string reason;
  if (!has_answer(
          [&] {
            const double temperature =
                thermal::lumped_temperature(film.fluid(), geometry.clearance, walls, told, start);
            (void)told(temperature);
            summary.set("temperature.lumped", temperature, "K");
            summary.set("load.lumped.x", -at.report.force[0], "N");
            summary.set("load.lumped.y", -at.report.force[1], "N");
            summary.set("power_loss.lumped", at.report.power, "W");
            summary.set("mass_flow.lumped", at.drawn, "kg/s");
          },
          &reason))
    summary.warnings.push_back(reason);
}

}  // namespace whirl::study
