#pragma once
// Which mode at one speed is which at the next.

#include <complex>
#include <cstddef>
#include <vector>

namespace whirl::spectral {

/// An eigenvalue [rad/s] with its shape at the nodes of the shaft, the displacements in x, then those in y.
struct ModePoint {
  std::complex<double> lambda;
  std::vector<std::complex<double>> shape;
};

struct ModeMatching {
  std::vector<int> before;  ///< for each mode at the second speed its place at the first, -1 if it was not there
  /// Every one of the modes that count has a partner of nearly its shape or nearly its eigenvalue. If not, the step was
  /// too long to tell, or a mode begins or ends within it.
  bool sure = true;
};

/// Pairs the modes of two near speeds, the most alike first: by the modal assurance criterion of the shapes less the
/// relative distance of the eigenvalues. The first `count` of each are those that count; the rest only helps to
/// recognise what comes from beyond. A pair that is neither of like shape nor of near eigenvalue is none.
[[nodiscard]] ModeMatching match_modes(const std::vector<ModePoint>& first, const std::vector<ModePoint>& second,
                                       std::size_t count);

}  // namespace whirl::spectral
