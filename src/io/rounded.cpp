#include "whirl/io/rounded.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace whirl::io {

std::string with_uncertainty(double value, double uncertainty, const std::string& unit) {
  const std::string tail = unit.empty() || unit == "1" ? "" : " " + unit;
  if (!std::isfinite(value)) return "unknown";
  const auto places = [](double x) { return -static_cast<int>(std::floor(std::log10(std::abs(x)))); };
  const int most = value == 0 ? 6 : 6 + places(value);
  if (!std::isfinite(uncertainty) || !(uncertainty > 0)) return fmt::format("{:.7g}{}", value, tail);
  const int size = -places(std::max(std::abs(value), uncertainty));
  if (size < -4 || size > 6) {
    const double unit_of_size = std::pow(10, size);
    return fmt::format("({})e{:+03d}{}", with_uncertainty(value / unit_of_size, uncertainty / unit_of_size, ""), size,
                       tail);
  }
  const int wanted = 1 + places(uncertainty);
  if (wanted > most) return fmt::format("{:.7g} +- {:.1g}{}", value, uncertainty, tail);
  const int decimals = std::max(0, wanted);
  return fmt::format("{:.{}f} +- {:.{}f}{}", value, decimals, uncertainty, decimals, tail);
}

}  // namespace whirl::io
