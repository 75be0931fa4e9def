#include "study/bearing/gas_point.hpp"

#include <cmath>
#include <numbers>

#include "whirl/film/contract/options.hpp"

namespace whirl::study {

double mean_free_path(const film::Gas& gas, double viscosity, double pressure) {
  return viscosity / pressure * std::sqrt(0.5 * std::numbers::pi * gas.gas_constant * gas.temperature);
}

namespace {

// Rarefaction where the gap is thinnest and the pressure that of the ends; the other numbers with the densest gas and
// the mean gap.
void put_numbers(GasPoint& p, const film::Gas& gas, const system::Support& s) {
  const double c = s.geometry.clearance, mu = s.lubricant.viscosity;
  const double density = p.report.max_pressure / (gas.gas_constant * gas.temperature);
  const double wall = std::abs(p.speed) * s.geometry.radius;
  p.knudsen = mean_free_path(gas, mu, gas.ambient) / p.report.min_thickness;
  p.reynolds = density * wall * c / mu;
  p.squeeze_reynolds = density * std::abs(p.speed) * c * c / mu;
  p.taylor = p.reynolds * std::sqrt(c / s.geometry.radius);
}

}  // namespace

GasPoint gas_at(const system::Support& support, double speed, const std::array<double, 2>& place) {
  film::Gas gas = *film::find<film::Gas>(support.film);
  gas.states = film::States::dynamic;
  const auto film = film::make_film(support.geometry, gas, support.lubricant);
  film::JournalMotion motion;
  motion.position = {place[0], place[1], 0, 0};
  motion.speed = speed;
  std::vector<double> states(film->states());
  film->unloaded(motion, states);
  GasPoint out;
  out.factorisations = film::relax(*film, motion, states);
  film::StateResponse answer;
  film->evaluate(motion, states, std::vector<double>(states.size(), 0.0), film::Need::force, answer);
  const std::array<double, 4>& force = answer.journal.force;
  out.speed = speed;
  out.place = place;
  out.eccentricity = std::hypot(place[0], place[1]) / support.geometry.clearance;
  out.load = std::hypot(force[0], force[1]);
  // The load is minus the force of the film.
  out.attitude =
      std::remainder(std::atan2(place[1], place[0]) - std::atan2(-force[1], -force[0]), 2 * std::numbers::pi);
  out.report = film->summary(motion, states);
  constexpr double normal_pressure = 101325, normal_temperature = 273.15, litres_a_minute = 60e3;
  out.normal_flow = out.report.mass_flow * gas.gas_constant * normal_temperature / normal_pressure * litres_a_minute;
  out.fields = film->fields(motion, states);
  put_numbers(out, gas, support);
  return out;
}

}  // namespace whirl::study
