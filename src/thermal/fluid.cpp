#include "whirl/thermal/fluid.hpp"

#include <algorithm>
#include <cmath>

namespace whirl::thermal {
namespace {

Valued of(const ConstantViscosity& law, double /*t*/) {
  return {law.value, 0};
}

Valued of(const Sutherland& law, double t) {
  const double mu =
      law.viscosity * std::pow(t / law.temperature, 1.5) * (law.temperature + law.constant) / (t + law.constant);
  return {mu, mu * (1.5 / t - 1 / (t + law.constant))};
}

Valued of(const Vogel& law, double t) {
  const double mu = law.viscosity * std::exp(law.b / (t - law.c) - law.b / (law.temperature - law.c));
  return {mu, -mu * law.b / ((t - law.c) * (t - law.c))};
}

Valued of(const Walther& law, double t) {
  const auto w = [](double nu) { return std::log10(std::log10(1e6 * nu + 0.7)); };
  const double x0 = std::log10(law.temperature[0]), x1 = std::log10(law.temperature[1]);
  const double b = (w(law.kinematic[0]) - w(law.kinematic[1])) / (x1 - x0), a = w(law.kinematic[0]) + b * x0;
  const double inner = std::pow(10.0, a - b * std::log10(t)), nu = std::pow(10.0, inner);
  return {law.density * 1e-6 * (nu - 0.7), law.density * 1e-6 * nu * std::log(10.0) * inner * -b / t};
}

// Beyond its least value the polynomial would rise again.
Valued of(const Quadratic& law, double t) {
  const auto& [c0, c1, c2] = law.coefficients;
  double x = (t - 273.15) / law.celsius;
  const bool beyond = c2 > 0 && x > -c1 / (2 * c2);
  if (beyond) x = -c1 / (2 * c2);
  return {law.viscosity * (c0 + x * (c1 + x * c2)), beyond ? 0.0 : law.viscosity * (c1 + 2 * c2 * x) / law.celsius};
}

}  // namespace

Valued viscosity(const Viscosity& law, double temperature) {
  return std::visit([&](const auto& l) { return of(l, temperature); }, law);
}

}  // namespace whirl::thermal
