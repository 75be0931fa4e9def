#pragma once
// The last point of a branch as a checkpoint holds it.

#include "whirl/core/petsc.hpp"
#include "whirl/io/record.hpp"
#include "whirl/solve/branch/continuation.hpp"

namespace whirl::study {

/// Point, unknowns, tangent, next step and memory; unknowns are in global order and whole, so that the number of ranks
/// may change.
void write_restart(io::Group& group, const solve::ResumePoint& at, Vec u, Vec tangent);
/// `like` has the layout of the unknowns.
[[nodiscard]] solve::Restart read_restart(const io::Group& group, Vec like);
/// The memory alone, its unknowns as put_vector() has them.
void write_memory(io::Group& group, const solve::BranchMemory& memory, bool shared);
[[nodiscard]] solve::BranchMemory read_memory(const io::Group& group, Vec like);

}  // namespace whirl::study
