#include "whirl/thermal/orifice.hpp"

#include <cmath>

namespace whirl::thermal {
namespace {

// sqrt(b^(2/k) - b^((k+1)/k)) and its derivative in the ratio b of pressures, below 1.
MassFlow shape(double k, double b) {
  const double critical = std::pow(2 / (k + 1), k / (k - 1));
  const bool choked = b < critical;
  if (choked) b = critical;
  const double a = std::pow(b, 2 / k), c = std::pow(b, (k + 1) / k), f = std::sqrt(a - c);
  return {f, choked ? 0 : (2 / k * a - (k + 1) / k * c) / (2 * b * f)};
}

}  // namespace

MassFlow nozzle(const PerfectGas& gas, double supply, double temperature, double pressure) {
  constexpr double width = 1e-3;
  const double k = gas.heat_ratio, factor = std::sqrt(2 * k / ((k - 1) * gas.gas_constant * temperature));
  const double b = pressure / supply;
  if (b < 1 - width) {
    const MassFlow f = shape(k, b);
    return {factor * supply * f.value, factor * f.slope};
  }
  const double edge = shape(k, 1 - width).value;
  if (b * (1 - width) <= 1) {  // from 1 - width to 1/(1 - width), where the flow back begins with the same value
    const double slope = edge / width;
    return {factor * supply * slope * (1 - b), -factor * slope};
  }
  const MassFlow f = shape(k, 1 / b);  // q = -factor p f(supply/p)
  return {-factor * pressure * f.value, -factor * (f.value - f.slope / b)};
}

double discharge(double thickness, double diameter) {
  return 0.85 * (1 - std::exp(-8.2 * thickness / diameter));
}

// Newton's method from the right, where the difference is convex, within a bracket.
Discharged discharged(double ideal, double rate, double unit) {
  const double a = std::abs(ideal), sign = ideal < 0 ? -1 : 1;
  double low = 0, high = a, m = a, number = 1, left = 1, slope = 1;
  for (int step = 0; step < 100; ++step) {
    const double re = m / unit;
    number = std::sqrt(re * re + 1);
    left = std::exp(-rate * number);  // what the coefficient lacks
    slope = 1 - a * rate * left * re / (number * unit);
    const double excess = m - a * (1 - left);
    (excess > 0 ? high : low) = m;
    double next = m - excess / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    const bool settled = std::abs(next - m) <= 4e-16 * a;
    m = next;
    if (settled) break;
  }
  return {sign * m, (1 - left) / slope, sign * a * number * left / slope};
}

}  // namespace whirl::thermal
