#pragma once
// How easily the film flows: h^3/(mu k), with k = 12 in laminar flow and larger in turbulence.

#include "whirl/film/options.hpp"

namespace whirl::film {

/// k = 12 + factor Re^exponent, Re = density speed radius h / viscosity with the local h.
struct Resistance {
  double factor, exponent;
};

/// Constantinescu's mixing-length form with k = 0.125 Re^0.07: k_x = 12 + 0.53 (k^2 Re)^0.725 around,
/// k_z = 12 + 0.296 (k^2 Re)^0.65 along; no laminar cut-off (Gavalas 2022, sec. 2.3, errata item 15).
Resistance resistance_around(Options::Turbulence turbulence);
Resistance resistance_along(Options::Turbulence turbulence);

/// k at a Reynolds number.
double evaluate(const Resistance& resistance, double reynolds);

/// a = scale h^3/(mu k) for `n` thicknesses, with da/dh and da/dOmega. `reynolds_per_h` = density |Omega| radius /
/// viscosity.
struct MobilityScale {
  double over_viscosity;  // scale / mu
  double reynolds_per_h;  // 1/m
  double inverse_speed;   // 1/Omega, or 0 at rest
};
void mobility(const Resistance& resistance, const MobilityScale& scale, int n, const double* h, double* a, double* a_h,
              double* a_speed);

}  // namespace whirl::film
