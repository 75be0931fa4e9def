// Compiled with vector mathematics allowed (see the build file): nothing here may depend on NaN or infinity.
#include "film/fluid/mobility.hpp"

#include <cmath>

namespace whirl::film {

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

void powers(double factor, double exponent, int n, const double* __restrict x, double* __restrict y) {
  for (int i = 0; i < n; ++i) y[i] = factor * std::exp(exponent * std::log(x[i]));
}

}  // namespace whirl::film
