#pragma once
// How easily the film flows: h^3/(mu k), k = 12 in laminar flow and larger in turbulence.

#include "whirl/film/contract/turbulence.hpp"

namespace whirl::film {

struct MobilityScale {
  double over_viscosity;  // scale / mu
  double reynolds_per_h;  // 1/m, density |Omega| radius / viscosity
  double inverse_speed;   // 1/Omega, or 0 at rest
};

/// a = scale h^3/(mu k) of `n` thicknesses, with da/dh and da/dOmega.
void mobility(const Resistance& resistance, const MobilityScale& scale, int n, const double* h, double* a, double* a_h,
              double* a_speed);

/// y = factor x^exponent of `n` positive numbers.
void powers(double factor, double exponent, int n, const double* x, double* y);

}  // namespace whirl::film
