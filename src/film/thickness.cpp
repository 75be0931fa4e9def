#include "whirl/film/thickness.hpp"

namespace whirl::film {

double default_minimum_film(const Geometry& geometry) {
  constexpr double lambda = 3, roughness = 1.0 / 6000;
  return lambda * roughness * geometry.clearance;
}

}  // namespace whirl::film
