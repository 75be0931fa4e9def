#pragma once
// Flow resistance of a turbulent film.

namespace whirl::film {

enum class Turbulence { laminar, constantinescu, ng_pan };

/// k = 12 + factor Re^exponent in h^3/(mu k) grad p, Re = density |Omega| R h/viscosity with the local h.
struct Resistance {
  double factor, exponent;
};

/// Constantinescu's mixing-length form with k = 0.125 Re^0.07: around the pad k_x = 12 + 0.53 (k^2 Re)^0.725 =
/// 12 + 0.0260 Re^0.8265, along it k_z = 12 + 0.296 (k^2 Re)^0.65 = 12 + 0.0198 Re^0.741; no laminar cut-off
/// (Gavalas 2022, sec. 2.3 with k corrected). Ng and Pan's fit (1965): k_x = 12 + 0.0136 Re^0.90, k_z = 12 + 0.0043
/// Re^0.96, made for 1000 <= Re <= 30000 and likewise without cut-off (Skarolek 2011, eqs. 1.50, 1.51, who calls it
/// Constantinescu's). Laminar: 12.
Resistance resistance_around(Turbulence turbulence);
Resistance resistance_along(Turbulence turbulence);

/// k at a Reynolds number.
double evaluate(const Resistance& resistance, double reynolds);

/// Shear of a turbulent film that is dragged along, over mu U/h: 1 + 0.0012 Re^0.94, Constantinescu's; laminar: 1.
double couette_factor(Turbulence turbulence, double reynolds);

}  // namespace whirl::film
