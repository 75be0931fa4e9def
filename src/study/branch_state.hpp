#pragma once
// The last point of a branch as a checkpoint holds it.

#include "whirl/core/petsc.hpp"
#include "whirl/io/record.hpp"
#include "whirl/solve/branch/continuation.hpp"

namespace whirl::study {

// What of these rows of numbers hold.
void members(auto& archive, solve::Stability& s) {
  archive(s.values, s.distance, s.neutral, s.missed, s.unknown, s.mesh_waves);
}
void members(auto& archive, solve::BranchPoint& p) {
  archive(p.index, p.filled, p.parameter, p.slope, p.step, p.newton_iterations, p.stability, p.monitors);
}
void members(auto& archive, solve::LocatedEvent& e) {
  archive(e.event, e.parameter, e.bracket, e.sensitivity, e.critical, e.located, e.refined, e.quadratic,
          e.unstable_before, e.unstable_after, e.slope, e.after);
}
void members(auto& archive, solve::BranchEnd& e) {
  archive(e.reason, e.completed, e.points, e.parameter, e.limited, e.bracket);
}
/// But for unknowns and tangents.
void members(auto& archive, solve::BranchMemory& m) {
  archive(m.before.point, m.earlier, m.visited, m.folds, m.met, m.held, m.warm, m.born, m.ranges, m.between);
}

/// Point, unknowns, tangent, next step and memory; unknowns are in global order and whole, so that the number of ranks
/// may change.
void write_restart(io::Group& group, const solve::ResumePoint& at, Vec u, Vec tangent);
/// `like` has the layout of the unknowns.
[[nodiscard]] solve::Restart read_restart(const io::Group& group, Vec like);
/// The memory alone, its unknowns as put_vector() has them.
void write_memory(io::Group& group, const solve::BranchMemory& memory, bool shared);
[[nodiscard]] solve::BranchMemory read_memory(const io::Group& group, Vec like);

}  // namespace whirl::study
