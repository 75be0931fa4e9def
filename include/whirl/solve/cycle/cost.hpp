#pragma once
// What the ways to join the intervals of a cycle cost, counted from sizes in the unit of core/cost.hpp.

#include <cstdint>

#include "whirl/core/plan.hpp"

namespace whirl::solve::cost {

/// A cycle of n states by collocation or steps.
struct CycleCounts {
  std::int64_t states = 0, borders = 1;
  std::int64_t intervals = 0, degree = 1;
  std::int64_t own = 0;      ///< states of films among them
  std::int64_t band = 0;     ///< neighbours that one of these sees, itself included
  std::int64_t forces = 0;   ///< nonlinear forces on the others
  std::int64_t entries = 0;  ///< of the linear blocks of the others
};

/// A point of a branch of cycles: three iterations of Newton's method, and multipliers.

/// Intervals joined by one dense matrix: all columns pass all intervals in every iteration, and LAPACK finds all
/// multipliers, in 70 n^3.
[[nodiscard]] double dense_joining(const CycleCounts& cycle);
/// Joined by sweeps: 50 columns pass the intervals one by one, in GMRES and in the search for leading multipliers.
[[nodiscard]] double sweeps(const CycleCounts& cycle);
/// Of a machine that is linear but for its forces, by modes in time, one sparse LU a point, and the same sweeps.
[[nodiscard]] double time_modes(const CycleCounts& cycle);

/// The way to take, where `films` have states of their own, or where modes in time serve a `linear` machine.
[[nodiscard]] core::plan::CycleWay cheapest(const CycleCounts& cycle, bool films, bool linear);

}  // namespace whirl::solve::cost
