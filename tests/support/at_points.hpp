#pragma once
// A cycle for solvers of another mesh and scheme.

#include "whirl/solve/cycle/cycle.hpp"

namespace whirl::test {

/// The states of `cycle` (made with `scheme`) at the points of another mesh, in the layout of degree 1: a guess for
/// ShootingProblem.
inline solve::Cycle at_points(const solve::Scheme& scheme, const solve::Cycle& cycle, const std::vector<double>& mesh) {
  solve::Cycle out{mesh, {}, cycle.period, cycle.parameter};
  out.x.resize(cycle.x.rows(), out.intervals());
  for (Eigen::Index i = 0; i < out.intervals(); ++i)
    out.x.col(i) = cycle.at(scheme, mesh[static_cast<std::size_t>(i) + 1]);
  return out;
}

}  // namespace whirl::test
