#pragma once
// The last point of a branch as a checkpoint holds it.

#include "whirl/core/petsc.hpp"
#include "whirl/io/record.hpp"
#include "whirl/solve/branch/continuation.hpp"

namespace whirl::study {

/// This rank's part of `all`, in the order of the global numbering, into v: the other way of core::gather.
void fill(Vec v, const std::vector<double>& all);

/// Point, unknowns, tangent and next step; unknowns are in global order, so that the number of ranks may change.
void write_restart(io::Group& group, const solve::BranchPoint& point, Vec u, Vec tangent, double next_step);
/// `like` has the layout of the unknowns.
[[nodiscard]] solve::Restart read_restart(const io::Group& group, Vec like);

}  // namespace whirl::study
