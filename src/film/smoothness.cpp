#include "whirl/film/smoothness.hpp"

namespace whirl::film {

Smoothness smoothness(const Options& o) {
  using enum Options::Kind;
  switch (o.kind) {
    case linear:
    case short_bearing:
    case long_bearing:
    case long_inlet:
    case finite_approximate:
      return {};
    case reynolds:
      if (o.cavitation == Options::Cavitation::none) return {};
      if (o.cavitation == Options::Cavitation::mass_conserving)
        return {0, "the force has kinks where the edge of the full film passes a node"};
      return {1, "the tangents have kinks where the edge of the positive pressure passes a node"};
    case compliant_short:
    case compliant_long:
    case compliant_finite:
      if (o.quadrature == Options::Quadrature::simpson)
        return {0, "the force has kinks where a nodal pressure changes its sign (quadrature: simpson)"};
      return {1, "the tangents have kinks where the edge of the positive pressure passes a node"};
  }
  return {0, "nothing is known of this kind of film"};
}

}  // namespace whirl::film
