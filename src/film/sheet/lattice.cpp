#include "film/sheet/lattice.hpp"

#include <cmath>
#include <cstdlib>
#include <numbers>

namespace whirl::film {

using std::numbers::pi;

// Simpson's rule; the integrand is smooth, and i/a/(2 pi) at k = 0.
double log_distance(double dx, double dz, int i, int j) {
  const double self = std::log(0.25 * std::hypot(dx, dz)) - std::numbers::egamma, a = dz / dx;
  i = std::abs(i);
  j = std::abs(j);
  if (i == 0 && j == 0) return self;
  const int n = 2 * (128 + 16 * (i + j));
  double sum = i / a;
  for (int m = 1; m <= n; ++m) {
    const double k = pi * m / n, s = 2.0 * std::asinh(std::sin(0.5 * k) / a);
    const double value = (1.0 - std::exp(-i * s) * std::cos(j * k)) / (a * std::sinh(s));
    sum += value * (m == n ? 1.0 : m % 2 == 1 ? 4.0 : 2.0);
  }
  return self + sum * pi / n / 3.0;
}

}  // namespace whirl::film
