#include "film/gas/gas_feed.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "film/sheet/lattice.hpp"
#include "film/sheet/pad.hpp"

namespace whirl::film {

using std::numbers::pi;

namespace {

// Of the pocket, or of the orifice.
double rim_of(const OrificeRow& row) {
  return 0.5 * (row.pocket ? row.pocket->diameter : row.diameter);
}

double angle_of(const OrificeRow& row, int k) {
  return row.angle + 2.0 * pi * k / row.count;
}

// The orifices of two rows that overlap, if any do.
std::optional<std::array<int, 2>> overlap(const OrificeRow& a, const OrificeRow& b, double radius) {
  const double least = rim_of(a) + rim_of(b), along = a.z - b.z;
  if (!(std::abs(along) < least)) return std::nullopt;
  for (int k = 0; k < a.count; ++k)
    for (int n = 0; n < b.count; ++n)
      if (std::hypot(radius * std::remainder(angle_of(a, k) - angle_of(b, n), 2.0 * pi), along) < least)
        return std::array<int, 2>{k, n};
  return std::nullopt;
}

}  // namespace

Misplaced misplaced_orifice(const Gas& gas, const Geometry& g) {
  std::vector<Pad> pads;
  if (g.type != Geometry::Bore::cylindrical) pads = make_pads(g);
  for (std::size_t row = 0; row < gas.orifices.size(); ++row) {
    const OrificeRow& r = gas.orifices[row];
    const std::string path = "orifices." + std::to_string(row + 1), widest = r.pocket ? path + ".pocket" : path;
    const double rim = rim_of(r);
    if (std::abs(r.z) + rim >= 0.5 * g.length) return {path + ".z", "orifices and pockets lie within the bearing"};
    const auto on = [&](double angle) {
      return pads.empty() || std::ranges::any_of(pads, [&](const Pad& pad) {
               const double away = std::abs(std::remainder(angle - pad.start - 0.5 * pad.arc, 2.0 * pi));
               return g.radius * (0.5 * pad.arc - away) > rim;
             });
    };
    for (int k = 0; k < r.count; ++k) {
      const double turn = 180.0 / pi * angle_of(r, k);
      if (!on(angle_of(r, k)))
        return {path + ".angle", fmt::format("orifice {} of the row, at {:.4g} deg, does not lie on a pad, free of its "
                                             "edges",
                                             k + 1, turn - 360.0 * std::floor(turn / 360.0))};
    }
    if (r.count > 1 && 2.0 * pi * g.radius / r.count < 2.0 * rim)
      return {widest, fmt::format("the {} of the row overlap: there are {:.3g} mm from one to the next",
                                  r.pocket ? "pockets" : "orifices", 2e3 * pi * g.radius / r.count)};
    for (std::size_t other = 0; other < row; ++other)
      if (const auto both = overlap(r, gas.orifices[other], g.radius))
        return {widest, fmt::format("orifice {} of the row overlaps orifice {} of row {}, pockets counted",
                                    (*both)[0] + 1, (*both)[1] + 1, other + 1)};
  }
  return {};
}

GasFeed::GasFeed(const OrificeRow& row, int k, const Gas& gas, double viscosity, const GasMesh& mesh)
    : row_(row),
      gas_{gas.gas_constant, gas.heat_ratio},
      temperature_(gas.temperature),
      viscosity_(viscosity),
      kind_(!row.pocket                                   ? Kind::simple
            : row.law == OrificeRow::Law::two_restrictors ? Kind::deep
                                                          : Kind::shallow),
      depth_(row.pocket ? row.pocket->depth : 0),
      rim_(rim_of(row)),
      angle_(angle_of(row, k)),
      z_(row.z) {
  if (row.pocket) capacity_ = pi * rim_ * rim_ * depth_ / (gas.gas_constant * gas.temperature);
  spread(mesh, row.pocket.has_value());
  if (gas.source == Gas::Source::node) distance_ = 0.0;
}

// Points along the rim of a pocket, or the one in the middle, each in the proportions of its cell. Nodes stop one short
// of the ends, where the pressure is given. Two points or more go to a cell: a ring then is smeared over its cells, and
// its nodes have less pressure than its rim, the less the finer the mesh. Points further apart than cells are wells of
// their own, whose nodes have more: the rim would resist negatively.
void GasFeed::spread(const GasMesh& mesh, bool ring) {
  const double cells = 2.0 * pi * rim_ / std::min(mesh.dx, mesh.dz);
  const int around = std::max(32, static_cast<int>(std::ceil(2.0 * cells)));
  std::map<std::pair<int, int>, double> weights;  // by line and place
  const int points = ring ? around : 1;
  for (int n = 0; n < points; ++n) {
    const double turn = 2.0 * pi * (n + 0.5) / points;
    const double x = ring ? rim_ * std::cos(turn) : 0.0, y = ring ? rim_ * std::sin(turn) : 0.0;
    double line = (angle_ - mesh.start) / mesh.dtheta + x / mesh.dx, place = (z_ + y + 0.5 * mesh.length) / mesh.dz - 1;
    place = std::clamp(place, 0.0, mesh.inner - 1.0);
    // What rounding leaves beside a node is none.
    for (double* v : {&line, &place})
      if (std::abs(*v - std::round(*v)) < 1e-9) *v = std::round(*v);
    const int l = static_cast<int>(std::floor(line)), m = static_cast<int>(std::floor(place));
    const double u = line - l, v = place - m;
    for (const auto& [dl, dm, w] :
         {std::tuple{0, 0, (1 - u) * (1 - v)}, {1, 0, u * (1 - v)}, {0, 1, (1 - u) * v}, {1, 1, u * v}})
      if (w > 0.0) weights[{l + dl, m + dm}] += w / points;
  }
  line_ = static_cast<int>(std::lround((angle_ - mesh.start) / mesh.dtheta));
  line_ = (line_ % mesh.lines + mesh.lines) % mesh.lines;
  std::map<std::pair<int, int>, double> known;
  double reach = 0.0;
  for (const auto& [a, w] : weights)
    for (const auto& [b, v] : weights) {
      const std::pair between{std::abs(a.first - b.first), std::abs(a.second - b.second)};
      const auto found = known.try_emplace(between, 0.0);
      if (found.second) found.first->second = log_distance(mesh.dx, mesh.dz, between.first, between.second);
      reach += w * v * found.first->second;
    }
  distance_ = std::log(rim_) - reach;
  for (const auto& [a, w] : weights)
    parts_.push_back({mesh.at((a.first % mesh.lines + mesh.lines) % mesh.lines, a.second), w});
}

bool GasFeed::crowds(const GasFeed& other, const GasMesh& mesh) const {
  return in_one_cell(std::remainder(angle_ - other.angle_, 2.0 * pi), mesh.dtheta) &&
         in_one_cell(z_ - other.z_, mesh.dz);
}

double GasFeed::scale() const {
  return 0.25 * pi * row_.diameter * row_.diameter * thermal::nozzle(gas_, row_.supply, temperature_, 0.0).value;
}

// c A nozzle(p_s, p) with c by the thickness, and by the flow where the law says so.
GasFeed::Passage GasFeed::orifice(double behind, double thickness) const {
  if (row_.law == OrificeRow::Law::curtain) return curtain(row_.supply, behind, row_.diameter, thickness);
  const double film = thickness + depth_, area = 0.25 * pi * row_.diameter * row_.diameter;
  const thermal::MassFlow jet = thermal::nozzle(gas_, row_.supply, temperature_, behind);
  // The coefficient tends to 0.85: its slope is what it lacks of that.
  const double c = thermal::discharge(film, row_.diameter), slope = (0.85 - c) * 8.2 / row_.diameter;
  const Passage plain{area * c * jet.value, 0.0, area * c * jet.slope, area * slope * jet.value};
  if (row_.law == OrificeRow::Law::thickness) return plain;
  constexpr double per_reynolds = 1e-3;
  const double deep = thickness + 4.0 * depth_, rate = per_reynolds * film / deep;
  const thermal::Discharged m = thermal::discharged(plain.mass, rate, 0.25 * pi * row_.diameter * viscosity_);
  return {m.mass, 0.0, m.by_ideal * plain.by_behind,
          m.by_ideal * plain.by_thickness + m.by_rate * per_reynolds * 3.0 * depth_ / (deep * deep)};
}

GasFeed::Passage GasFeed::curtain(double before, double behind, double diameter, double thickness) const {
  constexpr double most = 1.05, per_reynolds = 5e-3;
  const double width = most * pi * diameter, area = width * thickness;
  const thermal::MassFlow jet = thermal::nozzle(gas_, before, temperature_, behind);
  const thermal::Discharged m = thermal::discharged(area * jet.value, per_reynolds, pi * diameter * viscosity_);
  // A nozzle is homogeneous in its two pressures.
  return {m.mass, m.by_ideal * area * (jet.value - behind * jet.slope) / before, m.by_ideal * area * jet.slope,
          m.by_ideal * width * jet.value};
}

GasFlow GasFeed::into_film(const std::array<double, 2>& u, double thickness) const {
  if (kind_ == Kind::shallow) return {u[1], {0.0, 1.0}, 0.0};
  if (kind_ == Kind::simple) {
    const Passage m = orifice(u[0], thickness);
    return {m.mass, {m.by_behind, 0.0}, m.by_thickness};
  }
  const Passage m = curtain(u[1], u[0], 2.0 * rim_, thickness);
  return {m.mass, {m.by_behind, m.by_before}, m.by_thickness};
}

GasFlow GasFeed::into_pocket(const std::array<double, 2>& u, double thickness) const {
  const auto pocket = static_cast<std::size_t>(pocket_pressure());
  const Passage in = orifice(u[pocket], thickness);
  const GasFlow out = into_film(u, thickness);
  GasFlow sum{in.mass - out.mass, {-out.by[0], -out.by[1]}, in.by_thickness - out.by_thickness};
  sum.by[pocket] += in.by_behind;
  return sum;
}

// By halving the range of the pressure behind the orifice: with more of it less comes in and more is taken.
std::array<double, 2> GasFeed::steady(double pull, double resists, double thickness) const {
  const double least = std::sqrt(std::max(pull, 1e-6 * row_.supply * row_.supply));
  double low = std::min(least, row_.supply), high = std::max(least, row_.supply);
  double rim = low;
  for (int halving = 0; halving < 40; ++halving) {
    const double p = 0.5 * (low + high), mass = orifice(p, thickness).mass, square = pull + resists * mass;
    bool more = p * p < square;
    if (kind_ == Kind::deep) {
      rim = std::sqrt(std::max(square, 1e-6 * row_.supply * row_.supply));
      more = curtain(p, rim, 2.0 * rim_, thickness).mass < mass;
    }
    (more ? low : high) = p;
  }
  const double p = 0.5 * (low + high);
  if (kind_ == Kind::deep) return {rim, p};
  return {p, kind_ == Kind::shallow ? orifice(p, thickness).mass : 0.0};
}

}  // namespace whirl::film
