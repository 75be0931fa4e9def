#include "study/bearing/gas_point.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "study/bearing/film_at_rest.hpp"
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

std::span<const GasQuantity> gas_quantities() {
  static const std::vector<GasQuantity> all{
      {"load", "N", "that the film carries", [](const GasPoint& p) { return p.load; }},
      {"attitude", "rad", "from the load to the journal, with the rotation",
       [](const GasPoint& p) { return p.attitude; }},
      {"min_thickness", "m", "of the film", [](const GasPoint& p) { return p.report.min_thickness; }},
      {"max_pressure", "Pa", "in the film and behind orifices",
       [](const GasPoint& p) { return p.report.max_pressure; }},
      {"mass_flow", "kg/s", "through all orifices", [](const GasPoint& p) { return p.report.mass_flow; }},
      {"normal_flow", "l/min", "the same as gas at 0 degC and 101325 Pa",
       [](const GasPoint& p) { return p.normal_flow; }},
      {"drag_torque", "N m", "of the film on the journal", [](const GasPoint& p) { return p.report.drag_torque; }},
      {"power_loss", "W", "drag times speed", [](const GasPoint& p) { return p.report.power_loss; }},
      {"knudsen", "1", "mean free path at the pressure of the ends over the least thickness",
       [](const GasPoint& p) { return p.knudsen; }},
      {"reynolds", "1", "rho Omega R c/mu, rho at the highest pressure", [](const GasPoint& p) { return p.reynolds; }},
      {"squeeze_reynolds", "1", "rho Omega c^2/mu", [](const GasPoint& p) { return p.squeeze_reynolds; }},
      {"taylor", "1", "rho Omega R c/mu sqrt(c/R); vortices above 41", [](const GasPoint& p) { return p.taylor; }},
      {"factorisations", "1", "of Newton's method from the film between parallel plates",
       [](const GasPoint& p) { return static_cast<double>(p.factorisations); }}};
  return all;
}

std::size_t gas_quantity(std::string_view name) {
  const auto all = gas_quantities();
  return static_cast<std::size_t>(std::ranges::find(all, name, &GasQuantity::name) - all.begin());
}

GasRow gas_row(double speed, bool fields, const std::function<GasPoint()>& compute) {
  GasRow out;
  const WithoutFilm none = agreed_film(MPI_COMM_SELF, [&] {
    GasPoint p = compute();
    out.eccentricity = p.eccentricity;
    out.place = p.place;
    for (const GasQuantity& q : gas_quantities()) out.values.push_back(q.of(p));
    if (fields) out.fields = std::move(p.fields);
  });
  if (!none.reason.empty()) {
    out = {};
    out.values.assign(gas_quantities().size(), io::no_value);
    out.reason = none.reason;
    out.most = none.most;
  }
  out.speed = speed;
  return out;
}

}  // namespace whirl::study
