#pragma once
// Sizes that a quantity can have in a machine. What lies beyond is a slip of the pen, and ends in equations that no
// arithmetic can solve; the bounds are generous.

#include <string>
#include <string_view>

namespace whirl::deck {

/// Bounds of the size of a quantity (SI) that is not zero.
struct Magnitude {
  double least = 1e-30;
  double most = 1e30;
  [[nodiscard]] bool holds(double value) const noexcept;
  /// "1e-12 to 1e10 kg"
  [[nodiscard]] std::string text(std::string_view unit) const;
};

/// Of quantities of SI unit `unit`; bare numbers and units that are rare have the widest bounds.
[[nodiscard]] Magnitude plausible(std::string_view unit);

}  // namespace whirl::deck
