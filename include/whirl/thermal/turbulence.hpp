#pragma once
// Flow resistance, shear and eddies of a turbulent film, at the Reynolds number rho U h/mu of the journal's surface.

namespace whirl::thermal {

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
[[nodiscard]] Resistance resistance_around(Turbulence turbulence);
[[nodiscard]] Resistance resistance_along(Turbulence turbulence);

/// k at a Reynolds number.
[[nodiscard]] double evaluate(const Resistance& resistance, double reynolds);

/// Shear of a turbulent film that is dragged along, over mu U/h: 1 + 0.0012 Re^0.94, Constantinescu's; laminar: 1.
[[nodiscard]] double couette_factor(Turbulence turbulence, double reynolds);
/// What it has above one, as factor Re^exponent.
[[nodiscard]] Resistance couette_excess(Turbulence turbulence);

/// Turbulent Prandtl number, eddy viscosity over the eddies' diffusivity of heat; Kays (1994), at a wall far from it.
inline constexpr double turbulent_prandtl = 0.9;

/// Eddy viscosity over the fluid's, 0.4 (y - 10.7 tanh(y/10.7)), at a distance y+ = y sqrt(tau/rho) rho/mu from a wall
/// of shear tau; Reichardt (1951), the law behind Ng and Pan's (1965).
[[nodiscard]] double eddy_viscosity(double distance);

/// How much better heat is conducted across from s = `from` to `to` [shares of the film, 0 to 1] of a film than by the
/// resting fluid: (to - from)/int ds/(1 + Pr/Pr_t eddy_viscosity), where `half` is y+ in the middle of the film, whose
/// halves mirror each other.
[[nodiscard]] double eddy_conduction(double half, double prandtl, double from, double to);

}  // namespace whirl::thermal
