// The equations of a film of gas and their derivatives.
#include "film/gas/gas_film.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "film/gas/gas_part.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

using std::numbers::pi;

void demand(bool condition, const std::string& what) {
  if (!condition) throw core::InputError("film: " + what);
}

void check(const Geometry& g, const Gas& o, const Lubricant& l) {
  demand(g.radius > 0.0 && g.length > 0.0 && g.clearance > 0.0, "radius, length and clearance must be positive");
  demand(!o.lobes || (g.type == Geometry::Bore::cylindrical && o.lobes->count >= 2 && o.lobes->preload < 1.0),
         "lobes take the place of a circle");
  demand(o.cells[0] >= 4 && o.cells[1] >= 2, "at least 4 x 2 cells");
  demand(l.viscosity > 0.0, "the viscosity must be positive");
  demand(o.ambient > 0.0 && o.temperature > 0.0 && o.gas_constant > 0.0 && o.heat_ratio > 1.0,
         "pressures and temperatures of a gas are absolute and positive, and its ratio of heats is above 1");
  for (const OrificeRow& r : o.orifices) {
    demand(r.count >= 1 && r.diameter > 0.0 && r.supply > 0.0, "orifices need a number, a diameter and a supply");
    demand(!r.pocket || (r.pocket->diameter > r.diameter && r.pocket->depth > 0.0),
           "a pocket is wider than its orifice, and deep");
    demand(r.law != OrificeRow::Law::two_restrictors || r.pocket, "two restrictors need a pocket");
    demand(r.law != OrificeRow::Law::curtain || !r.pocket, "the curtain is that of an orifice without pocket");
    demand(o.source == Gas::Source::rim || !r.pocket, "a pocket has the pressure along its rim, not that of a node");
  }
  const Misplaced orifice = misplaced_orifice(o, g);
  demand(orifice.reason.empty(), orifice.reason);
}

}  // namespace

GasFilm::GasFilm(const Geometry& geometry, const Gas& options, const Lubricant& lubricant)
    : geometry_(geometry),
      options_(options),
      viscosity_(lubricant.viscosity),
      lines_(options.cells[0]),
      inner_(options.cells[1] - 1),
      bore_((check(geometry, options, lubricant), geometry), options) {
  dtheta_ = 2.0 * pi / lines_;
  dz_ = geometry.length / options.cells[1];
  dx_ = geometry.radius * dtheta_;
  mean_ = 2.0 * std::sin(0.5 * dtheta_) / dtheta_;
  nodes_ = static_cast<std::size_t>(lines_) * static_cast<std::size_t>(inner_);
  if (options.slip != Gas::Slip::none) {
    const double a = viscosity_ * std::sqrt(0.5 * pi * options.gas_constant * options.temperature);
    drive_.first = 12.0 * a;
    if (options.slip == Gas::Slip::second) drive_.second = 12.0 * a * a;
  }
  place_feeds();
}

std::span<const Port> GasFilm::ports() const {
  return std::span(all_ports).first(options_.tilt ? 4 : 2);
}

JournalMotion GasFilm::seen(JournalMotion motion) const {
  if (options_.tilt) return motion;
  motion.position[2] = motion.position[3] = motion.velocity[2] = motion.velocity[3] = 0.0;
  return motion;
}

double GasFilm::thickness(const JournalMotion& motion, int half_line, double place) const {
  const double along = z(place), at = angle(0.5 * half_line);
  return bore_.at(half_line) - (motion.position[0] + along * motion.position[2]) * std::cos(at) -
         (motion.position[1] + along * motion.position[3]) * std::sin(at);
}

// Flow per width times r T through the faces along theta, from line i to the next one.
void GasFilm::around(const Part& part) const {
  const double drag = 0.5 * geometry_.radius, couette = drag * part.motion.speed;
  const double by_x = 1.0 / (24.0 * viscosity_ * dx_);
  double* g = part.response.residual.data();
  double* d_speed = part.response.d_speed.data();
  for (int i = part.lines.begin - 1; i < part.lines.end; ++i) {
    const double c = std::cos(angle(i + 0.5)), s = std::sin(angle(i + 0.5)), gap = bore_.at(2 * i + 1);
    const bool left = i >= part.lines.begin, right = i + 1 < part.lines.end;
    const double* low = &part.states[seen_at(part.lines, i)];
    const double* high = low + inner_;
    for (int j = 0; j < inner_; ++j) {
      const std::size_t l = left ? row(part.lines, i, j) : 0, r = right ? row(part.lines, i + 1, j) : 0;
      const Part::Levers w = Part::levers(c, s, z(j));
      const double h = gap + part.turn(w), p = 0.5 * (low[j] + high[j]);
      const GasDrive::Rise rise = drive_.rise(h, low[j], high[j]);
      const double q = (couette * h * p - by_x * rise.value) / dx_;
      if (left) g[l] += q;
      if (right) g[r] -= q;
      if (!part.tangents) continue;
      const double half = 0.5 * couette * h;
      const double by_low = (half - by_x * rise.by_low) / dx_, by_high = (half - by_x * rise.by_high) / dx_;
      const double by_h = (couette * p - by_x * rise.by_h) / dx_, by_speed = drag * h * p / dx_;
      if (left) {
        part.centre[l] += by_low;
        part.after[l] += by_high;
        d_speed[l] += by_speed;
        part.add_position(l, by_h, w);
      }
      if (right) {
        part.before[r] -= by_low;
        part.centre[r] -= by_high;
        d_speed[r] -= by_speed;
        part.add_position(r, -by_h, w);
      }
    }
  }
}

// The same along z, from node j to j + 1; the pressure of the ends is given.
void GasFilm::along(const Part& part) const {
  const double by_z = 1.0 / (24.0 * viscosity_ * dz_ * dz_);
  double* g = part.response.residual.data();
  for (int i = part.lines.begin; i < part.lines.end; ++i) {
    const double c = std::cos(angle(i)), s = std::sin(angle(i)), gap = bore_.at(2 * i);
    const double* line = &part.states[seen_at(part.lines, i)];
    for (int j = -1; j < inner_; ++j) {
      const bool lower = j >= 0, upper = j + 1 < inner_;
      const std::size_t l = lower ? row(part.lines, i, j) : 0, r = upper ? row(part.lines, i, j + 1) : 0;
      const Part::Levers w = Part::levers(c, s, z(j + 0.5));
      const double low = lower ? line[j] : options_.ambient, high = upper ? line[j + 1] : options_.ambient;
      const GasDrive::Rise rise = drive_.rise(gap + part.turn(w), low, high);
      const double q = -by_z * rise.value;
      if (lower) g[l] += q;
      if (upper) g[r] -= q;
      if (!part.tangents) continue;
      const double by_low = -by_z * rise.by_low, by_high = -by_z * rise.by_high, by_h = -by_z * rise.by_h;
      if (lower) {
        part.centre[l] += by_low;
        if (upper) part.above[l] += by_high;
        part.add_position(l, by_h, w);
      }
      if (upper) {
        part.centre[r] -= by_high;
        if (lower) part.below[r] -= by_low;
        part.add_position(r, -by_h, w);
      }
    }
  }
}

// Balance over what a pascal adds to the cell, squeeze, and the force.
void GasFilm::close(const Part& part, std::span<const double> rates) const {
  StateResponse& response = part.response;
  const double area = dx_ * dz_;
  for (int i = part.lines.begin; i < part.lines.end; ++i) {
    const double c = std::cos(angle(i)), s = std::sin(angle(i));
    for (int j = 0; j < inner_; ++j) {
      const std::size_t k = row(part.lines, i, j), own = seen_at(part.lines, i) + static_cast<std::size_t>(j);
      const Part::Levers w = Part::levers(c, s, z(j));
      const double grows = mean_ * part.grows(w), p = part.states[own];
      if (bore_.held(i)) {
        hold(part, k, own, rates, w, bore_.pressure(i));
        continue;
      }
      const double over = 1.0 / (bore_.mean(i) + mean_ * part.turn(w));
      const double balance = (response.residual[k] + p * grows) * over;
      response.residual[k] = rates[own] + balance;
      for (std::size_t n = 0; n < ports().size(); ++n) {
        response.journal.force[static_cast<std::size_t>(ports()[n])] += (p - options_.ambient) * area * w[n];
        if (!part.tangents) continue;
        response.of_force(n)[k] = area * w[n];
        double& by_position = response.by_position(n)[k];
        by_position = (by_position - balance * mean_ * w[n]) * over;
        response.by_velocity(n)[k] = p * mean_ * w[n] * over;
      }
      if (!part.tangents) continue;
      response.d_speed[k] *= over;
      part.centre[k] = (part.centre[k] + grows) * over;
      for (double* v : {part.before, part.after, part.below, part.above}) v[k] *= over;
    }
  }
}

// A node in a groove, whose pressure goes to that of the groove by itself.
void GasFilm::hold(const Part& part, std::size_t k, std::size_t own, std::span<const double> rates,
                   const std::array<double, 4>& w, double pressure) const {
  StateResponse& response = part.response;
  const double p = part.states[own];
  response.residual[k] = rates[own] + typical_frequency * (p - pressure);
  for (std::size_t n = 0; n < ports().size(); ++n) {
    response.journal.force[static_cast<std::size_t>(ports()[n])] += (p - options_.ambient) * dx_ * dz_ * w[n];
    if (!part.tangents) continue;
    response.of_force(n)[k] = dx_ * dz_ * w[n];
    response.by_position(n)[k] = response.by_velocity(n)[k] = 0.0;
  }
  if (!part.tangents) return;
  response.d_speed[k] = 0.0;
  part.centre[k] = typical_frequency;
  for (double* v : {part.before, part.after, part.below, part.above}) v[k] = 0.0;
}

void GasFilm::evaluate(const JournalMotion& motion, const Share& share, std::span<const double> states,
                       std::span<const double> rates, Need need, StateResponse& response) {
  core::require(states.size() == share.seen.size() && rates.size() == states.size(), "what a share of a film sees");
  const bool tangents = need == Need::tangents;
  const auto rows = static_cast<std::size_t>(share.rows());
  response.journal = {};
  response.residual.assign(rows, 0.0);
  response.d_states.assign(tangents ? share.d_states.size() : 0, 0.0);
  response.d_rates.assign(tangents ? share.d_rates.size() : 0, 1.0);
  response.d_speed.assign(tangents ? rows : 0, 0.0);
  response.resize(tangents, std::ssize(ports()), share.rows());
  response.inputs.setZero();
  response.forces.setZero();
  response.journal.min_thickness = least_thickness(motion, states);
  if (!(response.journal.min_thickness > 0.0)) throw core::DomainError("film of gas: the surfaces touch");
  if (rows == 0) return;
  // But for the flows, which stand between the other unknowns and what feeds read of the nodes.
  const std::size_t read = states.size() - reads_, flows = read - (unknowns_ - flows_);
  for (std::size_t k = 0; k < states.size(); ++k)
    if (!(states[k] > 0.0) && (k < flows || k >= read))
      throw core::DomainError("film of gas: the pressure must be positive");

  Part part{seen(motion), lines_of(share), states, tangents, response, 0};
  part.rows = static_cast<std::size_t>(part.lines.count()) * static_cast<std::size_t>(inner_);
  if (tangents) {
    const auto entries = [&](Stencil::Place place) { return Stencil::at(place, part.rows, response.d_states.data()); };
    part.centre = entries(Stencil::centre);
    part.before = entries(Stencil::before);
    part.after = entries(Stencil::after);
    part.below = entries(Stencil::below);
    part.above = entries(Stencil::above);
  }
  around(part);
  along(part);
  feed(part, share, rates);
  close(part, rates);
}

double GasFilm::least_thickness(const JournalMotion& motion, std::span<const double> /*states*/) {
  return bore_.least(seen(motion).position);
}

}  // namespace whirl::film
