#pragma once
// What a lubricant is: its properties over temperature and pressure.

#include <array>
#include <string_view>
#include <variant>

#include "whirl/thermal/property.hpp"

namespace whirl::thermal {

/// mu = value.
struct ConstantViscosity {
  static constexpr std::string_view key = "constant", text = "the same at every temperature";
  double value = 0;  // Pa s
  friend bool operator==(const ConstantViscosity&, const ConstantViscosity&) = default;
};
/// mu = mu_0 (T/T_0)^(3/2) (T_0 + S)/(T + S), Sutherland (1893).
struct Sutherland {
  static constexpr std::string_view key = "sutherland", text = "of a gas, by Sutherland's law";
  double viscosity = 1.846e-5;  // Pa s, at
  double temperature = 300;     // K
  double constant = 110.4;      // K
  friend bool operator==(const Sutherland&, const Sutherland&) = default;
};
/// mu = mu_0 exp(b/(T - c) - b/(T_0 - c)), Vogel (1921).
struct Vogel {
  static constexpr std::string_view key = "vogel", text = "of an oil, by Vogel's law";
  double viscosity = 0, temperature = 313.15;  // Pa s, at K
  double b = 0, c = 0;                         // K
  friend bool operator==(const Vogel&, const Vogel&) = default;
};
/// log10 log10(nu + 0.7) = A - B log10 T, nu in mm^2/s, through two points; Walther (1931), ASTM D341.
struct Walther {
  static constexpr std::string_view key = "walther", text = "of an oil, by two kinematic viscosities (ASTM D341)";
  std::array<double, 2> kinematic{};    // m^2/s, at
  std::array<double, 2> temperature{};  // K
  double density = 0;                   // kg/m^3
  friend bool operator==(const Walther&, const Walther&) = default;
};
/// mu = mu_0 (c_0 + c_1 t + c_2 t^2), t = (T - 273.15 K)/T_0 with T_0 in degC; Ferron, Frene and Boncompain (1983).
/// The polynomial is held where it has its least value.
struct Quadratic {
  static constexpr std::string_view key = "quadratic",
                                    text = "of an oil, a polynomial of second degree in the temperature";
  double viscosity = 0, celsius = 40;  // Pa s, degC
  std::array<double, 3> coefficients{1, 0, 0};
  friend bool operator==(const Quadratic&, const Quadratic&) = default;
};
using Viscosity = std::variant<ConstantViscosity, Sutherland, Vogel, Walther, Quadratic>;

/// The law of a viscosity, as a choice.
struct ViscosityOptions {
  Viscosity law;
  friend bool operator==(const ViscosityOptions&, const ViscosityOptions&) = default;
};

/// Viscosity [Pa s] at a temperature [K] and its derivative [Pa s/K].
struct Valued {
  double value, slope;
};
[[nodiscard]] Valued viscosity(const Viscosity& law, double temperature);

/// A gas, rho = p/(r T), or a liquid. Laws over the temperature are factors of the values.
struct Fluid {
  Viscosity viscosity;
  bool gas = false;
  double gas_constant = 286.7;  // J/(kg K), of a gas
  double density = 0;           // kg/m^3, of a liquid
  double heat_capacity = 0;     // J/(kg K), at constant pressure
  double conductivity = 0;      // W/(m K)
  PropertyLaw density_law{}, heat_capacity_law{}, conductivity_law{};
  /// kg/m^3 at a pressure [Pa] and a temperature [K].
  [[nodiscard]] double rho(double p, double temperature) const {
    return gas ? p / (gas_constant * temperature) : density * evaluate(density_law, temperature).value;
  }
  /// J/(kg K), W/(m K) at a temperature [K]; the Prandtl number mu c/k there.
  [[nodiscard]] double c(double temperature) const {
    return heat_capacity * evaluate(heat_capacity_law, temperature).value;
  }
  [[nodiscard]] double k(double temperature) const {
    return conductivity * evaluate(conductivity_law, temperature).value;
  }
  [[nodiscard]] double prandtl(double temperature) const {
    return thermal::viscosity(viscosity, temperature).value * c(temperature) / k(temperature);
  }
};

}  // namespace whirl::thermal
