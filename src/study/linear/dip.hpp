#pragma once
// Where a curve known at three places may cross zero and return between them.

#include <array>
#include <optional>

namespace whirl::study {

/// The place at which the parabola through f(s), s rising, has its extreme, if f is of one sign, nearest to zero at the
/// middle place, and of the other sign at that extreme.
[[nodiscard]] std::optional<double> dip_of(const std::array<double, 3>& s, const std::array<double, 3>& f);

}  // namespace whirl::study
