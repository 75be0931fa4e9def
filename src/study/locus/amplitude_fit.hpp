#pragma once
// Where a curve of cycles ends as their amplitude goes to zero.

#include <vector>

namespace whirl::study {

/// What a quantity comes to at amplitude zero, and how far that may be wrong.
struct AtZeroAmplitude {
  double value = 0, bar = 0;
};

/// By least squares, of `values` along a curve of cycles with `amplitudes` > 0 (both [n], n >= 2):
///
///     v(A) = c_0 + c_1 A^2 + c_2 A^4
///
/// (without A^4 if n < 4): v is even, as the cycles come again half a period later. The bar is the largest residual,
/// plus the largest move of c_0 when one of the points is left out, plus its move with the next power. The points err
/// alike where they share a time mesh; this is what the last two parts show. Two points leave nothing to compare
/// with but their mean.
[[nodiscard]] AtZeroAmplitude at_zero_amplitude(const std::vector<double>& amplitudes,
                                                const std::vector<double>& values);

}  // namespace whirl::study
