#include "whirl/film/sheet/thickness.hpp"

#include <algorithm>
#include <limits>

#include "film/sheet/pad.hpp"

namespace whirl::film {

double default_minimum_film(const Geometry& geometry) {
  constexpr double lambda = 3, roughness = 1.0 / 6000;
  return lambda * roughness * geometry.clearance;
}

double minimum_thickness(const Geometry& geometry, const std::array<double, 4>& position) {
  double least = std::numeric_limits<double>::infinity();
  for (const Pad& pad : make_pads(geometry)) {
    const double X = position[0] - pad.centre_x, Y = position[1] - pad.centre_y;
    least = std::min(least, LeastThickness(pad)(X, Y, position[2], position[3]));
  }
  return least;
}

}  // namespace whirl::film
