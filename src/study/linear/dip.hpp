#pragma once
// Where a curve known at three places may cross zero and return between them.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace whirl::study {

/// The place at which the parabola through f(s), s rising, has its extreme, if f is of one sign, nearest to zero at the
/// middle place, and of the other sign at that extreme.
[[nodiscard]] inline std::optional<double> dip_of(const std::array<double, 3>& s, const std::array<double, 3>& f) {
  if (!(f[0] * f[1] > 0 && f[1] * f[2] > 0)) return {};
  if (std::abs(f[1]) > std::min(std::abs(f[0]), std::abs(f[2]))) return {};
  const double left = (f[1] - f[0]) / (s[1] - s[0]), right = (f[2] - f[1]) / (s[2] - s[1]),
               bend = (right - left) / (s[2] - s[0]);
  const double slope = left + bend * (s[1] - s[0]), at = s[1] - slope / (2 * bend);
  const double there = f[1] - slope * slope / (4 * bend);
  if (!(there * f[1] < 0) || at <= s[0] || at >= s[2]) return {};
  return at;
}

}  // namespace whirl::study
