#pragma once
// The whole matrix of a cycle, entry by entry.

#include "whirl/core/petsc.hpp"
#include "whirl/solve/cycle/composition.hpp"

namespace whirl::solve {

/// The linearised equations of a Run as one distributed matrix, solved by MUMPS (prefix "assembled_"): the check on
/// everything that eliminates. Unknowns are those of CycleProblem.
class AssembledCycle {
public:
  AssembledCycle() = default;
  /// `first` is this rank's first interval of `total`. Collective.
  AssembledCycle(const Run& run, Eigen::Index first, Eigen::Index total);
  /// x = matrix^-1 rhs. Collective.
  void solve(Vec rhs, Vec x);

private:
  core::Matrix matrix_;
  core::LinearSolver solver_;
};

}  // namespace whirl::solve
