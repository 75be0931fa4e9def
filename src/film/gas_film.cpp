// The equations of a film of gas and their derivatives.
#include "film/gas_film.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "whirl/core/error.hpp"
#include "whirl/film/thickness.hpp"

namespace whirl::film {
namespace {

using std::numbers::pi;

void demand(bool condition, const std::string& what) {
  if (!condition) throw core::InputError("film: " + what);
}

void check(const Geometry& g, const Gas& o, const Lubricant& l) {
  demand(g.radius > 0.0 && g.length > 0.0 && g.clearance > 0.0, "radius, length and clearance must be positive");
  demand(g.type == Geometry::Bore::cylindrical, "a film of gas stands in a whole circle: a cylindrical bore");
  demand(o.cells[0] >= 4 && o.cells[1] >= 2, "at least 4 x 2 cells");
  demand(l.viscosity > 0.0, "the viscosity must be positive");
  demand(o.ambient > 0.0 && o.temperature > 0.0 && o.gas_constant > 0.0 && o.heat_ratio > 1.0,
         "pressures and temperatures of a gas are absolute and positive, and its ratio of heats is above 1");
  for (const OrificeRow& r : o.orifices) {
    demand(r.count >= 1 && r.diameter > 0.0 && r.supply > 0.0, "orifices need a number, a diameter and a supply");
    demand(std::abs(r.z) < 0.5 * g.length, "orifices lie between the ends of the bearing");
  }
}

}  // namespace

GasFilm::GasFilm(const Geometry& geometry, const Gas& options, const Lubricant& lubricant)
    : geometry_(geometry),
      options_(options),
      viscosity_(lubricant.viscosity),
      gas_{options.gas_constant, options.heat_ratio},
      lines_(options.cells[0]),
      inner_(options.cells[1] - 1) {
  check(geometry, options, lubricant);
  dtheta_ = 2.0 * pi / lines_;
  dz_ = geometry.length / options.cells[1];
  dx_ = geometry.radius * dtheta_;
  mean_ = 2.0 * std::sin(0.5 * dtheta_) / dtheta_;
  nodes_ = static_cast<std::size_t>(lines_) * static_cast<std::size_t>(inner_);
  place_orifices();
  for (std::vector<double>* v : {&centre_, &after_, &before_, &above_, &below_}) v->resize(nodes_);
}

// At the nearest nodes of a mesh that begins at the first one.
void GasFilm::place_orifices() {
  if (!options_.orifices.empty()) start_ = options_.orifices.front().angle;
  for (const OrificeRow& r : options_.orifices)
    for (int k = 0; k < r.count; ++k) {
      const double turn = (r.angle - start_ + 2.0 * pi * k / r.count) / dtheta_;
      const int line = static_cast<int>(std::lround(turn)) % lines_;
      Orifice o{line < 0 ? line + lines_ : line,
                std::clamp(static_cast<int>(std::lround((r.z + 0.5 * geometry_.length) / dz_)) - 1, 0, inner_ - 1),
                r.diameter, r.supply};
      for (const Orifice& other : orifices_)
        demand(other.line != o.line || other.place != o.place, "two orifices lie at one node: the mesh is too coarse");
      orifices_.push_back(o);
    }
}

std::span<const Port> GasFilm::ports() const {
  return std::span(all_ports).first(options_.tilt ? 4 : 2);
}

std::vector<StateField> GasFilm::state_fields() const {
  const int n = static_cast<int>(nodes_), all = static_cast<int>(states());
  std::vector<StateField> out{{"pressure", "Pa", options_.ambient, 0, n}};
  if (all > n) out.push_back({"orifice_pressure", "Pa", options_.ambient, n, all, options_.ambient});
  return out;
}

int GasFilm::cut(int near) const {
  return 2 * static_cast<std::size_t>(near) > states() ? static_cast<int>(states()) : 0;
}

// Entries of nodes by diagonals: each of the five runs over the rows in their order.
Share GasFilm::share(int begin, int end) const {
  Share out{begin, end, {}, {}, {}};
  if (begin == end) return out;
  core::require(begin == 0 && end == static_cast<int>(states()), "a film of gas is held by one rank");
  out.seen.resize(static_cast<std::size_t>(end));
  std::iota(out.seen.begin(), out.seen.end(), 0);
  const int n = static_cast<int>(nodes_), m = inner_;
  out.d_states.add({0, 0, n});
  out.d_states.add({0, m, n - m});
  out.d_states.add({n - m, 0, m});
  out.d_states.add({0, n - m, m});
  out.d_states.add({m, 0, n - m});
  if (n > 1) {
    out.d_states.add({0, 1, n - 1});
    out.d_states.add({1, 0, n - 1});
  }
  for (std::size_t k = 0; k < orifices_.size(); ++k) {
    const int node = static_cast<int>(at(orifices_[k].line, orifices_[k].place)), own = n + static_cast<int>(k);
    out.d_states.add(node, own);
    out.d_states.add(own, node);
    out.d_states.add(own, own);
  }
  out.d_rates.add({0, 0, n});
  return out;
}

JournalMotion GasFilm::seen(JournalMotion motion) const {
  if (options_.tilt) return motion;
  motion.position[2] = motion.position[3] = motion.velocity[2] = motion.velocity[3] = 0.0;
  return motion;
}

double GasFilm::thickness(const JournalMotion& motion, double line, double place) const {
  const double along = z(place), at = angle(line);
  return geometry_.clearance - (motion.position[0] + along * motion.position[2]) * std::cos(at) -
         (motion.position[1] + along * motion.position[3]) * std::sin(at);
}

GasFilm::Flow GasFilm::flow(const Orifice& o, double pressure, double thickness) const {
  const thermal::MassFlow jet = thermal::nozzle(gas_, o.supply, options_.temperature, pressure);
  const double area = 0.25 * pi * o.diameter * o.diameter;
  // The coefficient tends to 0.85: its slope is what it lacks of that.
  const double c = thermal::discharge(thickness, o.diameter), slope = (0.85 - c) * 8.2 / o.diameter;
  return {area * c * jet.value, area * c * jet.slope, area * slope * jet.value};
}

void GasFilm::evaluate(const JournalMotion& motion_given, const Share& share, std::span<const double> states,
                       std::span<const double> rates, Need need, StateResponse& response) {
  core::require(states.size() == share.seen.size() && rates.size() == states.size(), "what a share of a film sees");
  const JournalMotion motion = seen(motion_given);
  const bool tangents = need == Need::tangents;
  const auto rows = static_cast<std::size_t>(share.rows());
  response.journal = {};
  response.residual.assign(rows, 0.0);
  response.d_states.resize(tangents ? share.d_states.size() : 0);
  response.d_rates.assign(tangents ? share.d_rates.size() : 0, 1.0);
  response.d_speed.assign(tangents ? rows : 0, 0.0);
  response.force_d_rates.clear();
  for (PortColumns* columns : {&response.d_position, &response.d_velocity, &response.force_d_states}) {
    columns->resize(ports().size());
    for (std::vector<double>& column : *columns) column.assign(tangents ? rows : 0, 0.0);
  }
  response.journal.min_thickness = least_thickness(motion, states);
  if (!(response.journal.min_thickness > 0.0)) throw core::DomainError("film of gas: the surfaces touch");
  if (rows == 0) return;
  for (const double p : states)
    if (!(p > 0.0)) throw core::DomainError("film of gas: the pressure must be positive");

  const std::size_t count = ports().size();
  // dh/d(position) at an angle, for all ports.
  const auto lever = [](double c, double s, double along) {
    return std::array<double, 4>{-c, -s, -along * c, -along * s};
  };
  std::vector<double>& g = response.residual;
  if (tangents)
    for (std::vector<double>* v : {&centre_, &after_, &before_, &above_, &below_}) std::fill(v->begin(), v->end(), 0.0);

  // Flow per width times r T through faces: along theta from line i to the next one, then along z.
  const double drag = 0.5 * geometry_.radius, couette = drag * motion.speed;
  const double by_x = 1.0 / (24.0 * viscosity_ * dx_), by_z = 1.0 / (24.0 * viscosity_ * dz_);
  for (int i = 0; i < lines_; ++i) {
    const int next = (i + 1) % lines_;
    const double c = std::cos(angle(i + 0.5)), s = std::sin(angle(i + 0.5));
    for (int j = 0; j < inner_; ++j) {
      const std::size_t l = at(i, j), r = at(next, j);
      const std::array<double, 4> w = lever(c, s, z(j));
      const double h = geometry_.clearance + motion.position[0] * w[0] + motion.position[1] * w[1] +
                       motion.position[2] * w[2] + motion.position[3] * w[3];
      const double p = 0.5 * (states[l] + states[r]), h2 = h * h;
      const double fall = by_x * (states[r] * states[r] - states[l] * states[l]);
      const double q = (couette * h * p - h2 * h * fall) / dx_;
      g[l] += q;
      g[r] -= q;
      if (!tangents) continue;
      const double half = 0.5 * couette * h, cube = 2.0 * by_x * h2 * h;
      const double by_l = (half + cube * states[l]) / dx_, by_r = (half - cube * states[r]) / dx_;
      centre_[l] += by_l;
      after_[l] += by_r;
      before_[r] -= by_l;
      centre_[r] -= by_r;
      const double by_h = (couette * p - 3.0 * h2 * fall) / dx_, by_speed = drag * h * p / dx_;
      response.d_speed[l] += by_speed;
      response.d_speed[r] -= by_speed;
      for (std::size_t n = 0; n < count; ++n) {
        response.d_position[n][l] += by_h * w[n];
        response.d_position[n][r] -= by_h * w[n];
      }
    }
  }
  for (int i = 0; i < lines_; ++i) {
    const double c = std::cos(angle(i)), s = std::sin(angle(i));
    for (int j = -1; j < inner_; ++j) {  // from node j to j + 1
      const std::array<double, 4> w = lever(c, s, z(j + 0.5));
      const double h = geometry_.clearance + motion.position[0] * w[0] + motion.position[1] * w[1] +
                       motion.position[2] * w[2] + motion.position[3] * w[3];
      const double low = pressure(states, i, j), high = pressure(states, i, j + 1), h2 = h * h;
      const double fall = by_z * (high * high - low * low), q = -h2 * h * fall / dz_;
      const bool has_low = j >= 0, has_high = j + 1 < inner_;
      const std::size_t l = has_low ? at(i, j) : 0, r = has_high ? at(i, j + 1) : 0;
      if (has_low) g[l] += q;
      if (has_high) g[r] -= q;
      if (!tangents) continue;
      const double cube = 2.0 * by_z * h2 * h / dz_, by_h = -3.0 * h2 * fall / dz_;
      if (has_low) centre_[l] += cube * low;
      if (has_low && has_high) above_[l] -= cube * high;
      if (has_high) centre_[r] += cube * high;
      if (has_low && has_high) below_[r] -= cube * low;
      for (std::size_t n = 0; n < count; ++n) {
        if (has_low) response.d_position[n][l] += by_h * w[n];
        if (has_high) response.d_position[n][r] -= by_h * w[n];
      }
    }
  }

  // Orifices.
  const double warmth = options_.gas_constant * options_.temperature;
  const double to_cell = warmth / (dx_ * dz_), mesh = 0.25 * std::exp(-std::numbers::egamma) * std::hypot(dx_, dz_);
  std::vector<double> by_flow(orifices_.size());
  for (std::size_t k = 0; k < orifices_.size(); ++k) {
    const Orifice& o = orifices_[k];
    const std::size_t node = at(o.line, o.place), own = nodes_ + k;
    const double h = thickness(motion, o.line, o.place), p = states[node], behind = states[own];
    const Flow m = flow(o, behind, h);
    const double distance = options_.source == Gas::Source::rim ? std::log(0.5 * o.diameter / mesh) : 0.0;
    const double resists = 12.0 * viscosity_ * warmth / (pi * h * h * h) * distance, unit = 0.5 / o.supply;
    g[node] -= to_cell * m.mass;
    g[own] = unit * (behind * behind - p * p + resists * m.mass);
    if (!tangents) continue;
    by_flow[k] = -to_cell * m.by_pressure;
    const std::array<double, 4> w = lever(std::cos(angle(o.line)), std::sin(angle(o.line)), z(o.place));
    for (std::size_t n = 0; n < count; ++n) {
      response.d_position[n][node] -= to_cell * m.by_thickness * w[n];
      response.d_position[n][own] = unit * resists * (m.by_thickness - 3.0 * m.mass / h) * w[n];
    }
    double* entry = response.d_states.data() + share.d_states.size() - 3 * (orifices_.size() - k);
    entry[1] = -2.0 * unit * p;
    entry[2] = unit * (2.0 * behind + resists * m.by_pressure);
  }

  // Balance over what a pascal adds to the cell, squeeze, and the force.
  const double area = dx_ * dz_;
  for (int i = 0; i < lines_; ++i) {
    const double c = std::cos(angle(i)), s = std::sin(angle(i));
    for (int j = 0; j < inner_; ++j) {
      const std::size_t k = at(i, j);
      const std::array<double, 4> w = lever(c, s, z(j));
      double turn = 0.0, grows = 0.0;
      for (std::size_t n = 0; n < 4; ++n) {
        turn += motion.position[n] * w[n];
        grows += motion.velocity[n] * w[n];
      }
      const double h = geometry_.clearance + mean_ * turn, over = 1.0 / h, p = states[k];
      const double balance = (g[k] + p * mean_ * grows) * over;
      g[k] = rates[k] + balance;
      for (std::size_t n = 0; n < count; ++n) {
        const auto force = static_cast<std::size_t>(ports()[n]);
        response.journal.force[force] += (p - options_.ambient) * area * w[n];
        if (!tangents) continue;
        response.force_d_states[n][k] = area * w[n];
        response.d_position[n][k] = (response.d_position[n][k] - balance * mean_ * w[n]) * over;
        response.d_velocity[n][k] = p * mean_ * w[n] * over;
      }
      if (!tangents) continue;
      response.d_speed[k] *= over;
      centre_[k] = (centre_[k] + mean_ * grows) * over;
      for (std::vector<double>* v : {&after_, &before_, &above_, &below_}) (*v)[k] *= over;
    }
  }
  if (!tangents) return;
  auto out = response.d_states.begin();
  out = std::copy(centre_.begin(), centre_.end(), out);
  out = std::copy(after_.begin(), after_.end(), out);
  out = std::copy(before_.begin(), before_.end(), out);
  if (nodes_ > 1) {
    out = std::copy(above_.begin(), above_.end() - 1, out);
    out = std::copy(below_.begin() + 1, below_.end(), out);
  }
  for (std::size_t k = 0; k < orifices_.size(); ++k) {
    const Orifice& o = orifices_[k];
    const double turn = thickness(motion, o.line, o.place) - geometry_.clearance;
    out[static_cast<std::ptrdiff_t>(3 * k)] = by_flow[k] / (geometry_.clearance + mean_ * turn);
  }
}

double GasFilm::least_thickness(const JournalMotion& motion, std::span<const double> /*states*/) {
  return minimum_thickness(geometry_, seen(motion).position);
}

}  // namespace whirl::film
