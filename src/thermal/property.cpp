#include "whirl/thermal/property.hpp"

#include <cmath>

namespace whirl::thermal {
namespace {

LawValue of(const ConstantLaw& /*law*/, double /*t*/) {
  return {1, 0};
}
double integrate(const ConstantLaw& /*law*/, double from, double to) {
  return to - from;
}

LawValue of(const LinearLaw& law, double t) {
  return {1 + law.slope * (t - law.temperature), law.slope};
}
// The difference stands in front of all integrals, so that they are exact to rounding between close temperatures.
double integrate(const LinearLaw& law, double from, double to) {
  return (to - from) * (1 + law.slope * (0.5 * (from + to) - law.temperature));
}

LawValue of(const PolynomialLaw& law, double t) {
  const double x = t / law.temperature;
  double value = 0, slope = 0;
  for (std::size_t n = law.coefficients.size(); n-- > 0;) {
    slope = slope * x + value;
    value = value * x + law.coefficients[n];
  }
  return {value, slope / law.temperature};
}
// x^(n+1) - y^(n+1) = (x - y) sum x^m y^(n-m)
double integrate(const PolynomialLaw& law, double from, double to) {
  const double x = to / law.temperature, y = from / law.temperature;
  double sum = 0, terms = 1, power = 1;
  for (std::size_t n = 0; n < law.coefficients.size(); ++n) {
    sum += law.coefficients[n] / static_cast<double>(n + 1) * terms;
    power *= y;
    terms = terms * x + power;
  }
  return (to - from) * sum;
}

LawValue of(const PowerLaw& law, double t) {
  const double value = std::pow(t / law.temperature, law.exponent);
  return {value, law.exponent * value / t};
}
double integrate(const PowerLaw& law, double from, double to) {
  const double ratio = std::log(to / from), n = law.exponent + 1;
  const double start = from * std::pow(from / law.temperature, law.exponent);
  return std::abs(n) < 1e-12 ? start * ratio : start * std::expm1(n * ratio) / n;
}

}  // namespace

LawValue evaluate(const PropertyLaw& law, double temperature) {
  return std::visit([&](const auto& l) { return of(l, temperature); }, law);
}

double integral(const PropertyLaw& law, double from, double to) {
  return std::visit([&](const auto& l) { return integrate(l, from, to); }, law);
}

bool is_constant(const PropertyLaw& law) {
  return std::holds_alternative<ConstantLaw>(law);
}

}  // namespace whirl::thermal
