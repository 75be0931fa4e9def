#include "plausible.hpp"

#include <fmt/core.h>

#include <cmath>
#include <map>

#include "whirl/deck/units.hpp"

namespace whirl::deck {

bool Magnitude::holds(double value) const noexcept {
  const double size = std::abs(value);
  return size == 0 || (size >= least && size <= most);
}

std::string Magnitude::text(std::string_view unit) const {
  return fmt::format("{} to {}{}{}", write_number(least), write_number(most), unit.empty() ? "" : " ", unit);
}

// From microscopic rotors to the largest turbines, with some powers of ten to spare on both sides. Dimensionless
// problems are often written in SI units near one, and penalties in stiffnesses far above that of any steel.
Magnitude plausible(std::string_view unit) {
  static const std::map<std::string_view, Magnitude> bounds{
      {"m", {1e-12, 1e6}},       {"kg", {1e-12, 1e10}},   {"s", {1e-15, 1e10}},    {"rad/s", {1e-9, 1e9}},
      {"rad/s^2", {1e-12, 1e9}}, {"rad", {1e-12, 1e6}},   {"K", {1e-3, 1e5}},      {"Pa", {1e-9, 1e16}},
      {"Pa s", {1e-9, 1e6}},     {"kg/m^3", {1e-6, 1e6}}, {"N", {1e-15, 1e15}},    {"N/m", {1e-12, 1e20}},
      {"N s/m", {1e-15, 1e18}},  {"m/s", {1e-15, 1e6}},   {"m/s^2", {1e-12, 1e8}}, {"kg m", {1e-18, 1e10}},
      {"kg m^2", {1e-24, 1e15}}, {"byte", {1e6, 1e15}},   {"Hz", {1e-9, 1e9}}};
  const auto at = bounds.find(coherent(unit));
  return at == bounds.end() ? Magnitude{} : at->second;
}

}  // namespace whirl::deck
