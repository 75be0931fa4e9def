#pragma once
// A number with its unit and its error.

#include <limits>
#include <map>
#include <string>

namespace whirl::io {

inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// A number with its unit; NaN and infinity become null in the file.
struct Quantity {
  double value = no_value;
  std::string unit = {};
  std::map<std::string, double> more = {};  ///< "uncertainty" and its parts, in the same unit

  /// "uncertainty", in `unit`: the value is within this much on either side; 0 if it is not known.
  [[nodiscard]] double bar() const;
};

}  // namespace whirl::io
