// Compiled with vector mathematics allowed (see the build file): nothing here may depend on NaN or infinity.
#include "film/mobility.hpp"

#include <cmath>

namespace whirl::film {
namespace {

// 0.125^2 Re^1.14 is k^2 Re of the mixing-length form.
Resistance mixing_length(double factor, double exponent) {
  return {factor * std::pow(0.125 * 0.125, exponent), 1.14 * exponent};
}

}  // namespace

Resistance resistance_around(Turbulence turbulence) {
  if (turbulence == Turbulence::laminar) return {0.0, 1.0};
  if (turbulence == Turbulence::ng_pan) return {0.0136, 0.90};
  return mixing_length(0.53, 0.725);
}

Resistance resistance_along(Turbulence turbulence) {
  if (turbulence == Turbulence::laminar) return {0.0, 1.0};
  if (turbulence == Turbulence::ng_pan) return {0.0043, 0.96};
  return mixing_length(0.296, 0.65);
}

double evaluate(const Resistance& resistance, double reynolds) {
  return 12.0 + resistance.factor * std::pow(reynolds, resistance.exponent);
}

double couette_factor(Turbulence turbulence, double reynolds) {
  return turbulence == Turbulence::laminar ? 1.0 : 1.0 + 0.0012 * std::pow(reynolds, 0.94);
}

void mobility(const Resistance& r, const MobilityScale& scale, int n, const double* __restrict h, double* __restrict a,
              double* __restrict a_h, double* __restrict a_speed) {
  if (r.factor == 0.0 || scale.reynolds_per_h == 0.0) {
    for (int i = 0; i < n; ++i) {
      a[i] = scale.over_viscosity / 12.0 * h[i] * h[i] * h[i];
      a_h[i] = scale.over_viscosity / 4.0 * h[i] * h[i];
      a_speed[i] = 0.0;
    }
    return;
  }
  const double log_reynolds_per_h = std::log(scale.reynolds_per_h);
  const double exponent = r.exponent, factor = r.factor, over = scale.over_viscosity, inverse = scale.inverse_speed;
  for (int i = 0; i < n; ++i) {
    const double extra = factor * std::exp(exponent * (log_reynolds_per_h + std::log(h[i])));
    const double k = 1.0 / (12.0 + extra);
    const double slope = exponent * extra * k;  // d ln k / d ln h = d ln k / d ln Omega
    const double value = over * h[i] * h[i] * h[i] * k;
    a[i] = value;
    a_h[i] = value * (3.0 - slope) / h[i];
    a_speed[i] = -value * slope * inverse;
  }
}

}  // namespace whirl::film
