#include "whirl/thermal/turbulence.hpp"

#include <algorithm>
#include <cmath>

namespace whirl::thermal {
namespace {

// 0.125^2 Re^1.14 is k^2 Re of the mixing-length form.
Resistance mixing_length(double factor, double exponent) {
  return {factor * std::pow(0.125 * 0.125, exponent), 1.14 * exponent};
}

// int dy/(1 + share eddy_viscosity(y)) by Simpson's rule in t = ln(1 + y): the sublayer has as many points as the core.
double resistance(double share, double from, double to) {
  constexpr int intervals = 16;
  const double first = std::log1p(from), step = (std::log1p(to) - first) / intervals;
  double sum = 0;
  for (int k = 0; k <= intervals; ++k) {
    const double grown = std::exp(first + k * step), weight = k == 0 || k == intervals ? 1 : (k % 2 == 1 ? 4 : 2);
    sum += weight * grown / (1 + share * eddy_viscosity(grown - 1));
  }
  return sum * step / 3;
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
  const Resistance excess = couette_excess(turbulence);
  return excess.factor == 0.0 ? 1.0 : 1.0 + excess.factor * std::pow(reynolds, excess.exponent);
}

Resistance couette_excess(Turbulence turbulence) {
  if (turbulence == Turbulence::laminar) return {0.0, 1.0};
  return {0.0012, 0.94};
}

double eddy_viscosity(double distance) {
  const double y = distance / 10.7;
  // Where y - tanh(y) would be a difference of equals.
  const double beyond = y < 1e-2 ? y * y * y / 3 * (1 - 0.4 * y * y) : y - std::tanh(y);
  return 0.4 * 10.7 * beyond;
}

double eddy_conduction(double half, double prandtl, double from, double to) {
  const double share = prandtl / turbulent_prandtl;
  if (!(half > 0)) return 1;
  const auto y = [&](double s) { return 2 * half * s; };
  double all = 0;
  if (from < 0.5) all += resistance(share, y(from), y(std::min(to, 0.5)));
  if (to > 0.5) all += resistance(share, y(1 - to), y(1 - std::max(from, 0.5)));
  return y(to - from) / all;
}

}  // namespace whirl::thermal
