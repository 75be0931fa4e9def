#pragma once
// How fast the Poincare points of a motion go round: the rotation number.

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace whirl::transient {

/// Mean of f over an orbit with the weights exp(-1/(s (1 - s))), s = (i + 1/2)/n: on a smooth quasi-periodic motion its
/// error falls faster than any power of 1/n, where that of the plain mean falls as 1/n. Source: Das, Saiki, Sander and
/// Yorke (2017), Nonlinearity 30, 4111.
[[nodiscard]] double smooth_mean(std::span<const double> values);

/// p/q in lowest terms; q = 0: none.
struct Ratio {
  int p = 0, q = 0;
};
/// The ratio of the least denominator within `bar` of `value`, if that is no accident: the expected number of ratios
/// of denominators up to its own in an interval of this width is below one in a hundred. Source: Stern and Brocot for
/// the search; 3 q^2/pi^2 ratios in the unit interval.
[[nodiscard]] Ratio ratio_within(double value, double bar);

/// Turns per return of points that go round a closed curve.
struct RotationNumber {
  double value = 0;        ///< in [0, 1): whole turns between the points are not seen; NaN if there is none
  double uncertainty = 0;  ///< half the width of the interval that holds it
  Ratio locked;            ///< the ratio of small numbers that it is within the uncertainty, if any
  double disorder = 0;     ///< share of neighbours on the curve whose images are in another order; zero on a circle
  std::string reason;      ///< why there is none
};

/// Of points in the order of time, by the angle about their middle, from the first axis to the second. They are on an
/// invariant circle that is seen once round from its middle if the map keeps their order: more disorder than one in a
/// hundred means that there is no such circle, and no number. The uncertainty is the largest difference of the
/// smooth means of the record and of its halves, which is far above the error of the whole one's, and not below
/// rounding; a record of few turns has a wide one. At least 24 points. Source for the order: Katok and Hasselblatt
/// (1995), sec. 11.1.
[[nodiscard]] RotationNumber rotation_number(const std::vector<std::array<double, 2>>& points);

/// The same of points that repeat themselves after `period` returns: exactly p/period. None where three or more of them
/// are on a line, whose order about its middle means nothing.
[[nodiscard]] RotationNumber locked_rotation(const std::vector<std::array<double, 2>>& points, int period);

}  // namespace whirl::transient
