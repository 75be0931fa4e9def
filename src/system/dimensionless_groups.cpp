#include "whirl/system/dimensionless_groups.hpp"

#include <cmath>
#include <complex>

namespace whirl::system {

double load_of_rigid(const Train& train) {
  const auto& r = train.rotor;
  double x = r.mass * train.gravity_x, y = r.mass * train.gravity + r.load;
  for (const StaticLoad& l : train.loads) {
    x += l.force[0];
    y -= l.force[1];
  }
  return x == 0 ? y : std::hypot(x, y);
}

std::optional<DimensionlessGroups> dimensionless_groups(const Train& train) {
  const auto& r = train.rotor;
  if (r.type != rotor::Options::Type::rigid || train.supports.empty()) return std::nullopt;
  const Support& first = train.supports.front();
  const film::Geometry& g = first.geometry;
  for (const Support& s : train.supports)
    if (film::facts(s.film).coefficients || !film::same_kind(s.film, first.film) || s.geometry.type != g.type ||
        s.geometry.radius != g.radius || s.geometry.length != g.length || s.geometry.clearance != g.clearance ||
        s.lubricant.viscosity != first.lubricant.viscosity)
      return std::nullopt;
  const double load = load_of_rigid(train), ratio = g.clearance / g.radius;
  if (!(load > 0)) return std::nullopt;
  DimensionlessGroups out;
  out.speed_scale = std::sqrt(load / (r.mass * g.clearance));
  out.load = ratio * ratio * load / (first.lubricant.viscosity * out.speed_scale * g.length * 2 * g.radius);
  std::complex<double> unbalance = 0;
  for (const UnbalanceMass& u : train.unbalance) unbalance += std::polar(u.amount, u.phase);
  out.unbalance = std::abs(unbalance) / (r.mass * g.clearance);
  out.length_to_diameter = 0.5 * g.length / g.radius;
  out.bearings = static_cast<int>(train.supports.size());
  return out;
}

}  // namespace whirl::system
