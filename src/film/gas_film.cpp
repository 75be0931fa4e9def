// The equations of a film of gas and their derivatives.
#include "film/gas_film.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "film/gas_inverse.hpp"
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

// At whole lines; the rank that holds the last one holds the pressures behind the orifices too.
int GasFilm::cut(int near) const {
  const int line = (near + inner_ / 2) / inner_;
  return line < lines_ ? line * inner_ : static_cast<int>(states());
}

// Lines held and those beside them, then the pressures behind all orifices and at their nodes. The entries between
// nodes are a Stencil, with the zeros at the ends of lines; those of orifices follow.
Share GasFilm::share(int begin, int end) const {
  Share out{begin, end, {}, {}, {}};
  if (begin == end) return out;
  const int nodes = static_cast<int>(nodes_), held = std::min(end, nodes), n = held - begin;
  core::require(begin % inner_ == 0 && (end == static_cast<int>(states()) || (end < nodes && end % inner_ == 0)),
                "a film that is cut at whole lines");
  for (int k = begin - inner_; k < held + inner_; ++k) out.seen.push_back((k % nodes + nodes) % nodes);
  const int first = n + 2 * inner_, count = static_cast<int>(orifices_.size());
  for (int k = 0; k < count; ++k) out.seen.push_back(nodes + k);
  for (const Orifice& o : orifices_) out.seen.push_back(static_cast<int>(at(o.line, o.place)));
  for (const int offset : {0, -inner_, inner_, -1, 1}) out.d_states.add({0, inner_ + offset, n});
  for (int k = 0; k < count; ++k) {
    const Orifice& o = orifices_[static_cast<std::size_t>(k)];
    const int node = static_cast<int>(at(o.line, o.place));
    if (node >= begin && node < held) out.d_states.add(node - begin, first + k);
    if (end == held) continue;
    out.d_states.add(n + k, first + count + k);
    out.d_states.add(n + k, first + k);
  }
  out.d_rates.add({0, inner_, n});
  return out;
}

std::unique_ptr<StatePreconditioner> GasFilm::preconditioner(MPI_Comm comm, const Share& share) const {
  const Lines here = lines_of(share);
  int least = here.count();
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_INT, MPI_MIN, comm);
  if (least < 2) return nullptr;
  std::vector<int> nodes;
  for (const Orifice& o : orifices_) nodes.push_back(static_cast<int>(at(o.line, o.place)));
  return std::make_unique<GasInverse>(comm, lines_, inner_, share, std::move(nodes));
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

struct GasFilm::Part {
  JournalMotion motion;
  Lines lines;
  std::span<const double> states;
  bool tangents;
  StateResponse& response;
  std::size_t rows;  // of nodes
  double *centre = nullptr, *before = nullptr, *after = nullptr, *below = nullptr, *above = nullptr;

  // dh/d(position) at an angle, for all ports.
  using Levers = std::array<double, 4>;
  static Levers levers(double c, double s, double along) { return {-c, -s, -along * c, -along * s}; }
  [[nodiscard]] double turn(const Levers& w) const {
    return motion.position[0] * w[0] + motion.position[1] * w[1] + motion.position[2] * w[2] +
           motion.position[3] * w[3];
  }
  [[nodiscard]] double grows(const Levers& w) const {
    return motion.velocity[0] * w[0] + motion.velocity[1] * w[1] + motion.velocity[2] * w[2] +
           motion.velocity[3] * w[3];
  }
  void add_position(std::size_t row, double by_h, const Levers& w) const {
    for (std::size_t n = 0; n < response.d_position.size(); ++n) response.d_position[n][row] += by_h * w[n];
  }
};

// Flow per width times r T through the faces along theta, from line i to the next one.
void GasFilm::around(const Part& part) const {
  const double drag = 0.5 * geometry_.radius, couette = drag * part.motion.speed;
  const double by_x = 1.0 / (24.0 * viscosity_ * dx_);
  double* g = part.response.residual.data();
  double* d_speed = part.response.d_speed.data();
  for (int i = part.lines.begin - 1; i < part.lines.end; ++i) {
    const double c = std::cos(angle(i + 0.5)), s = std::sin(angle(i + 0.5));
    const bool left = i >= part.lines.begin, right = i + 1 < part.lines.end;
    const double* low = &part.states[seen_at(part.lines, i)];
    const double* high = low + inner_;
    for (int j = 0; j < inner_; ++j) {
      const std::size_t l = left ? row(part.lines, i, j) : 0, r = right ? row(part.lines, i + 1, j) : 0;
      const Part::Levers w = Part::levers(c, s, z(j));
      const double h = geometry_.clearance + part.turn(w), h2 = h * h;
      const double p = 0.5 * (low[j] + high[j]), fall = by_x * (high[j] * high[j] - low[j] * low[j]);
      const double q = (couette * h * p - h2 * h * fall) / dx_;
      if (left) g[l] += q;
      if (right) g[r] -= q;
      if (!part.tangents) continue;
      const double half = 0.5 * couette * h, cube = 2.0 * by_x * h2 * h;
      const double by_low = (half + cube * low[j]) / dx_, by_high = (half - cube * high[j]) / dx_;
      const double by_h = (couette * p - 3.0 * h2 * fall) / dx_, by_speed = drag * h * p / dx_;
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
  const double by_z = 1.0 / (24.0 * viscosity_ * dz_);
  double* g = part.response.residual.data();
  for (int i = part.lines.begin; i < part.lines.end; ++i) {
    const double c = std::cos(angle(i)), s = std::sin(angle(i));
    const double* line = &part.states[seen_at(part.lines, i)];
    for (int j = -1; j < inner_; ++j) {
      const bool lower = j >= 0, upper = j + 1 < inner_;
      const std::size_t l = lower ? row(part.lines, i, j) : 0, r = upper ? row(part.lines, i, j + 1) : 0;
      const Part::Levers w = Part::levers(c, s, z(j + 0.5));
      const double h = geometry_.clearance + part.turn(w), h2 = h * h;
      const double low = lower ? line[j] : options_.ambient, high = upper ? line[j + 1] : options_.ambient;
      const double fall = by_z * (high * high - low * low), q = -h2 * h * fall / dz_;
      if (lower) g[l] += q;
      if (upper) g[r] -= q;
      if (!part.tangents) continue;
      const double cube = 2.0 * by_z * h2 * h / dz_, by_h = -3.0 * h2 * fall / dz_;
      if (lower) {
        part.centre[l] += cube * low;
        if (upper) part.above[l] -= cube * high;
        part.add_position(l, by_h, w);
      }
      if (upper) {
        part.centre[r] += cube * high;
        if (lower) part.below[r] -= cube * low;
        part.add_position(r, -by_h, w);
      }
    }
  }
}

// What orifices give to their nodes, and the rows of the pressures behind them.
void GasFilm::through_orifices(const Part& part, const Share& share) const {
  const double warmth = options_.gas_constant * options_.temperature;
  const double to_cell = warmth / (dx_ * dz_), mesh = 0.25 * std::exp(-std::numbers::egamma) * std::hypot(dx_, dz_);
  const std::size_t count = orifices_.size(), first = part.states.size() - 2 * count;
  const bool owns = static_cast<std::size_t>(share.rows()) > part.rows;
  StateResponse& response = part.response;
  double* entry = part.tangents ? response.d_states.data() + 5 * part.rows : nullptr;
  for (std::size_t k = 0; k < count; ++k) {
    const Orifice& o = orifices_[k];
    const bool here = o.line >= part.lines.begin && o.line < part.lines.end;
    if (!here && !owns) continue;
    const Part::Levers w = Part::levers(std::cos(angle(o.line)), std::sin(angle(o.line)), z(o.place));
    const double turn = part.turn(w), h = geometry_.clearance + turn;
    const double behind = part.states[first + k], p = part.states[first + count + k];
    const Flow m = flow(o, behind, h);
    if (here) {
      const std::size_t node = row(part.lines, o.line, o.place);
      response.residual[node] -= to_cell * m.mass;
      if (part.tangents) {
        part.add_position(node, -to_cell * m.by_thickness, w);
        *entry++ = -to_cell * m.by_pressure / (geometry_.clearance + mean_ * turn);
      }
    }
    if (!owns) continue;
    const double distance = options_.source == Gas::Source::rim ? std::log(0.5 * o.diameter / mesh) : 0.0;
    const double resists = 12.0 * viscosity_ * warmth / (pi * h * h * h) * distance, unit = 0.5 / o.supply;
    const std::size_t own = part.rows + k;
    response.residual[own] = unit * (behind * behind - p * p + resists * m.mass);
    if (!part.tangents) continue;
    part.add_position(own, unit * resists * (m.by_thickness - 3.0 * m.mass / h), w);
    *entry++ = -2.0 * unit * p;
    *entry++ = unit * (2.0 * behind + resists * m.by_pressure);
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
      const double over = 1.0 / (geometry_.clearance + mean_ * part.turn(w));
      const double balance = (response.residual[k] + p * grows) * over;
      response.residual[k] = rates[own] + balance;
      for (std::size_t n = 0; n < ports().size(); ++n) {
        response.journal.force[static_cast<std::size_t>(ports()[n])] += (p - options_.ambient) * area * w[n];
        if (!part.tangents) continue;
        response.force_d_states[n][k] = area * w[n];
        response.d_position[n][k] = (response.d_position[n][k] - balance * mean_ * w[n]) * over;
        response.d_velocity[n][k] = p * mean_ * w[n] * over;
      }
      if (!part.tangents) continue;
      response.d_speed[k] *= over;
      part.centre[k] = (part.centre[k] + grows) * over;
      for (double* v : {part.before, part.after, part.below, part.above}) v[k] *= over;
    }
  }
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
  through_orifices(part, share);
  close(part, rates);
}

double GasFilm::least_thickness(const JournalMotion& motion, std::span<const double> /*states*/) {
  return minimum_thickness(geometry_, seen(motion).position);
}

}  // namespace whirl::film
