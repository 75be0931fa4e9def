#pragma once
// Flow resistance of a turbulent film.

namespace whirl::film {

enum class Turbulence { laminar, constantinescu };

/// k = 12 + factor Re^exponent in h^3/(mu k) grad p, Re = density |Omega| R h/viscosity with the local h.
struct Resistance {
  double factor, exponent;
};

/// Constantinescu's mixing-length form with k = 0.125 Re^0.07: around the pad k_x = 12 + 0.53 (k^2 Re)^0.725 =
/// 12 + 0.0260 Re^0.8265, along it k_z = 12 + 0.296 (k^2 Re)^0.65 = 12 + 0.0198 Re^0.741; no laminar cut-off
/// (Gavalas 2022, sec. 2.3 with k corrected). Laminar: 12.
Resistance resistance_around(Turbulence turbulence);
Resistance resistance_along(Turbulence turbulence);

/// k at a Reynolds number.
double evaluate(const Resistance& resistance, double reynolds);

}  // namespace whirl::film
