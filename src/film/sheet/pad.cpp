#include "film/sheet/pad.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "whirl/core/error.hpp"

namespace whirl::film {

std::vector<Pad> make_pads(const Geometry& g, const Inlet& inlet) {
  if (g.type == Geometry::Bore::cylindrical) {
    const bool free = inlet.type == Inlet::Type::free;
    const double start = free ? 0.5 * std::numbers::pi : inlet.type == Inlet::Type::line ? inlet.angle : 0.0;
    return {{g.radius, g.length, g.clearance, start, 2.0 * std::numbers::pi, 0.0, 0.0, free}};
  }
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

LeastThickness::LeastThickness(const Pad& pad)
    : clearance_(pad.clearance),
      half_length_(0.5 * pad.length),
      middle_{std::cos(pad.start + 0.5 * pad.arc), std::sin(pad.start + 0.5 * pad.arc)},
      first_{std::cos(pad.start), std::sin(pad.start)},
      last_{std::cos(pad.start + pad.arc), std::sin(pad.start + pad.arc)},
      half_(pad.closed ? -1.0 : std::cos(0.5 * pad.arc)) {}

double LeastThickness::operator()(double X, double Y) const {
  const double r = std::sqrt(X * X + Y * Y);
  if (!(X * middle_[0] + Y * middle_[1] < r * half_)) return clearance_ - r;
  return clearance_ - std::max(X * first_[0] + Y * first_[1], X * last_[0] + Y * last_[1]);
}

double LeastThickness::operator()(double X, double Y, double tx, double ty) const {
  const double x = half_length_ * tx, y = half_length_ * ty;
  return std::min((*this)(X + x, Y + y), (*this)(X - x, Y - y));
}

void require_thickness(double h_min) {
  if (!(h_min > 0.0))
    throw core::DomainError("film thickness is not positive: " + fmt::format("{:.4g}", h_min * 1e6) + " um");
}

}  // namespace whirl::film
