#include "film/liner.hpp"

#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

// F(x) = 4.4086e-5 (4 - x)^6.804.
constexpr double kFactor = 4.4086e-5, kExponent = 6.804, kReach = 4.0;

}  // namespace

LinerLaw::LinerLaw(const Geometry& geometry, const Options& options, double b, double pressure)
    : stiffness_(1.0 / b), damping_(options.liner_damping / b), rubber_(options.rubber_thickness.has_value()) {
  if (rubber_) thickness_ = *options.rubber_thickness / geometry.clearance;
  if (!options.contact) return;
  reach_ = kReach * options.contact->roughness / geometry.clearance;
  scale_ = kFactor * std::pow(kReach, kExponent) * options.contact->pressure / pressure;
}

LinerLaw::Value LinerLaw::elastic(double u) const {
  if (!rubber_) return {stiffness_ * u, stiffness_};
  const double left = 1.0 - std::abs(u) / thickness_;
  if (!(left > 0.0)) throw core::DomainError("the liner has no thickness left");
  const double square = 1.0 / (left * left);
  return {std::copysign(stiffness_ * thickness_ / 3.0 * (square - left), u),
          stiffness_ / 3.0 * (2.0 * square / left + 1.0)};
}

LinerLaw::Value LinerLaw::contact(double h) const {
  if (h >= reach_) return {0.0, 0.0};
  const double gap = 1.0 - h / reach_, p = scale_ * std::pow(gap, kExponent);
  return {p, -kExponent * p / (gap * reach_)};
}

}  // namespace whirl::film
