#pragma once
// How a property of a lubricant changes with the temperature: a factor, so that the law knows no unit.

#include <array>
#include <string_view>
#include <variant>

namespace whirl::thermal {

/// f = 1.
struct ConstantLaw {
  static constexpr std::string_view key = "constant", text = "the same at every temperature";
};
/// f = 1 + a (T - T_0): density (a about -7e-4 1/K), heat capacity (2e-3 1/K) and conductivity (-5e-4 1/K) of mineral
/// oils between 0 and 200 degC; Cragoe (1929) for the latter two.
struct LinearLaw {
  static constexpr std::string_view key = "linear", text = "a straight line over the temperature, as of oils";
  double temperature = 313.15;  // K, where f = 1
  double slope = 0;             // 1/K
};
/// f = sum c_n (T/T_0)^n. The heat capacity of air from 300 to 1000 K is r times this with T_0 = 1000 K and c = 3.653,
/// -1.337, 3.294, -1.913, 0.2763; Moran and Shapiro (2000), table A-21.
struct PolynomialLaw {
  static constexpr std::string_view key = "polynomial", text = "a polynomial of fourth degree in T/T_0";
  double temperature = 300;                           // K, T_0
  std::array<double, 5> coefficients{1, 0, 0, 0, 0};  // -, of T/T_0
};
/// f = (T/T_0)^n: the conductivity of air is 0.0241 W/(m K) times this with T_0 = 273.15 K and n = 0.9.
struct PowerLaw {
  static constexpr std::string_view key = "power", text = "a power of the temperature, as the conductivity of a gas";
  double temperature = 273.15;  // K, where f = 1
  double exponent = 0;          // -
};
using PropertyLaw = std::variant<ConstantLaw, LinearLaw, PolynomialLaw, PowerLaw>;

/// f [-] at a temperature [K], its slope [1/K], and its integral from `from` to there [K].
struct LawValue {
  double value, slope;
};
[[nodiscard]] LawValue evaluate(const PropertyLaw& law, double temperature);
[[nodiscard]] double integral(const PropertyLaw& law, double from, double to);
[[nodiscard]] bool is_constant(const PropertyLaw& law);

}  // namespace whirl::thermal
