#pragma once
// One number of a cycle, such as an amplitude or the period, with its exact derivative.

#include <Eigen/Core>
#include <vector>

#include "whirl/solve/cycle/cycle.hpp"

namespace whirl::solve {

/// The largest value over a cycle of direction . p, or of |p| where `direction` is zero; p(s) is a path in the plane, a
/// Cycle of two rows.
struct CyclePeak {
  double value = 0, time = 0;  ///< time: s in [0, 1]
  Eigen::Matrix2Xd by_nodes;   ///< its derivative by the path at the nodes [2 x N m]
};

/// The maximum of the intervals' own polynomials, not of samples. At a maximum the value does not change with the time,
/// so its derivative is that at a fixed time. Of equal peaks the first counts.
[[nodiscard]] CyclePeak peak_of(const Scheme& scheme, const Cycle& path, const Eigen::Vector2d& direction);
/// Whether the value falls by more than `depth` on the shorter way from the time `before` to the peak: where the peak
/// stood at `before` on a neighbouring cycle, another one has become the largest since.
[[nodiscard]] bool another_peak(const Scheme& scheme, const Cycle& path, const Eigen::Vector2d& direction,
                                const CyclePeak& peak, double before, double depth);

/// factor times the sum of peaks in `directions`, or the period T [s], or 2 pi/(T Omega).
struct CycleQuantity {
  enum class Kind { peaks, period, whirl_ratio };
  Kind kind = Kind::peaks;
  std::vector<Eigen::Vector2d> directions;  ///< of peaks: d and -d for the travel along d
  double factor = 1;

  struct Value {
    double value = 0, by_period = 0;
    Eigen::Matrix2Xd by_nodes;  ///< [2 x N m]; empty without peaks
  };
  /// `speed` Omega [rad/s].
  [[nodiscard]] Value of(const Scheme& scheme, const Cycle& path, double speed) const;
};

}  // namespace whirl::solve
