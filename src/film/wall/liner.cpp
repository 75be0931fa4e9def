#include "film/wall/liner.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

// F(x) = 4.4086e-5 (4 - x)^6.804.
constexpr double kFactor = 4.4086e-5, kExponent = 6.804, kReach = 4.0;

}  // namespace

void Carried::resize(std::size_t nodes) {
  for (auto* values : {&p, &by_h, &by_u, &by_rate, &contact, &stiff}) values->assign(nodes, 0.0);
}

void Carried::clear(std::size_t first, std::size_t count) {
  for (auto* values : {&p, &by_h, &by_u, &by_rate, &contact, &stiff})
    std::fill_n(values->begin() + static_cast<std::ptrdiff_t>(first), count, 0.0);
}

LinerLaw::LinerLaw(const Geometry& geometry, const Compliant& options, double b, double pressure)
    : stiffness_(1.0 / b), damping_(options.liner_damping / b), rubber_(options.rubber_thickness.has_value()) {
  if (rubber_) thickness_ = *options.rubber_thickness / geometry.clearance;
  if (!options.contact) return;
  reach_ = kReach * options.contact->roughness / geometry.clearance;
  scale_ = kFactor * std::pow(kReach, kExponent) * options.contact->pressure / pressure;
}

bool LinerLaw::rubber(std::span<const double> u, double* __restrict p, double* __restrict slope) const {
  const double per_thickness = 1.0 / thickness_, scale = stiffness_ * thickness_ / 3.0, third = stiffness_ / 3.0;
  long crushed = 0;
  for (std::size_t k = 0; k < u.size(); ++k) {
    const double left = 1.0 - std::abs(u[k]) * per_thickness, inverse = 1.0 / left, square = inverse * inverse;
    crushed |= left > 0.0 ? 0 : 1;
    p[k] = std::copysign(scale * (square - left), u[k]);
    slope[k] = third * (2.0 * square * inverse + 1.0);
  }
  return crushed == 0;
}

LinerLaw::Value LinerLaw::elastic(double u) const {
  if (!rubber_) return {stiffness_ * u, stiffness_};
  Value v{};
  if (!rubber({&u, 1}, &v.pressure, &v.slope)) throw core::DomainError("the liner has no thickness left");
  return v;
}

LinerLaw::Value LinerLaw::contact(double h) const {
  if (h >= reach_) return {0.0, 0.0};
  const double gap = 1.0 - h / reach_, p = scale_ * std::pow(gap, kExponent);
  return {p, -kExponent * p / (gap * reach_)};
}

void LinerLaw::carry(std::span<const double> h, std::span<const double> u, std::span<const double> rates,
                     std::size_t first, Carried& out) const {
  const std::size_t n = u.size();
  double* __restrict p = &out.p[first], * __restrict by_u = &out.by_u[first], * __restrict by_h = &out.by_h[first];
  if (!rubber_)
    for (std::size_t k = 0; k < n; ++k) {
      p[k] = stiffness_ * u[k];
      by_u[k] = by_h[k] = stiffness_;
    }
  else {
    if (!rubber(u, p, by_u)) throw core::DomainError("the liner has no thickness left");
    std::copy_n(by_u, n, by_h);
  }
  if (damped())
    for (std::size_t k = 0; k < n; ++k) {
      p[k] += damping_ * rates[k];
      out.by_rate[first + k] = damping_;
    }
  if (!touches()) return;
  for (std::size_t k = 0; k < n; ++k) {
    const Value v = contact(h[k]);
    out.contact[first + k] = v.pressure;
    out.stiff[first + k] = v.slope;
    p[k] -= v.pressure;
    by_h[k] -= v.slope;
  }
}

// phi(u)/b - P_c(rigid + u) rises with u from u = 0 on, where it is negative: Newton between two bounds.
LinerLaw::Edge LinerLaw::edge(double rigid) const {
  if (!touches() || rigid >= reach_) return {rigid};
  if (std::isnan(rigid)) throw core::DomainError("the journal is nowhere");
  double low = 0.0, high = rubber_ ? std::min(reach_ - rigid, thickness_) : reach_ - rigid, u = 0.0;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Value elastic = this->elastic(u), touch = contact(rigid + u);
    const double excess = elastic.pressure - touch.pressure, slope = elastic.slope - touch.slope, step = excess / slope;
    if (std::abs(step) <= 1e-14 * (reach_ + u)) return {rigid + u, elastic.slope / slope, touch};
    (excess > 0.0 ? high : low) = u;
    u = u - step > low && u - step < high ? u - step : 0.5 * (low + high);
  }
  throw core::DomainError("the liner does not settle on the asperities at an edge of the bearing");
}

}  // namespace whirl::film
