#include "film/pad.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <string>

#include "whirl/core/error.hpp"

namespace whirl::film {

std::vector<Pad> make_pads(const Geometry& g) {
  if (g.type == Geometry::Bore::cylindrical)
    return {{g.radius, g.length, g.clearance, 0.5 * std::numbers::pi, 2.0 * std::numbers::pi, 0.0, 0.0, true}};
  const double machined = g.clearance / (1.0 - g.preload);
  const double rise = machined - g.clearance;  // the centre of each arc lies beyond the bearing centre
  const bool lobes = g.type == Geometry::Bore::lemon_bore;
  const double shift = lobes ? 0.5 * g.offset : 0.0;
  const double half = 0.5 * g.arc;
  std::vector<Pad> pads = {{g.radius, g.length, machined, 1.5 * std::numbers::pi - half, g.arc, shift, rise, false}};
  if (lobes) pads.push_back({g.radius, g.length, machined, 0.5 * std::numbers::pi - half, g.arc, -shift, -rise, false});
  return pads;
}

Grid::Grid(const Pad& pad, const std::array<int, 2>& cells)
    : n_theta(cells[0]),
      n_z(cells[1]),
      dtheta(pad.arc / n_theta),
      dz(pad.length / n_z),
      mean(2.0 * std::sin(0.5 * dtheta) / dtheta) {
  for (int i = 0; i <= n_theta; ++i) {
    const double node = pad.start + i * dtheta;
    node_cos.push_back(std::cos(node));
    node_sin.push_back(std::sin(node));
    if (i == n_theta) break;
    const double face = pad.start + (i + 0.5) * dtheta;
    face_cos.push_back(std::cos(face));
    face_sin.push_back(std::sin(face));
  }
}

void require_thickness(double h_min) {
  if (!(h_min > 0.0))
    throw core::DomainError("film thickness is not positive: " + fmt::format("{:.4g}", h_min * 1e6) + " um");
}

}  // namespace whirl::film
