#pragma once
// A few points of a curve that are kept with their solutions until the whole curve is known.

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "whirl/solve/cycle/cycle.hpp"

namespace whirl::study {

/// A point of a curve of bifurcations; an equilibrium stands as a cycle of one node.
struct CurvePoint {
  solve::Cycle cycle;     ///< its parameter is the first one [SI]
  Eigen::VectorXd inner;  ///< inner unknowns of the condition
  double second = 0;      ///< scaled
  double arclength = 0;   ///< from the start, in the scaled parameters
  std::size_t row = 0;    ///< points of the curve between the start and this one
  void members(auto& archive) {
    archive(cycle.mesh, cycle.x, cycle.period, cycle.parameter, inner, second, arclength, row);
  }
};

/// Points about evenly spread over a curve whose length is not known before: wherever there are too many, the distance
/// between neighbours is doubled. The last point is always among them.
class SpreadPoints {
public:
  explicit SpreadPoints(std::size_t most) : most_(most) {}
  void add(CurvePoint point);
  void clear();
  [[nodiscard]] std::vector<CurvePoint> all() const;
  void members(auto& archive) { archive(apart_, spread_, last_); }

private:
  std::size_t most_;
  double apart_ = 0;
  std::vector<CurvePoint> spread_, last_;  // last_: none, or the last point where it is too near to be spread
};

/// The `count` (at least two) of the points that lie next to places evenly spread over their arclength, both ends among
/// them; `points` are sorted by it.
[[nodiscard]] std::vector<CurvePoint> evenly_spread(std::vector<CurvePoint> points, std::size_t count);

}  // namespace whirl::study
