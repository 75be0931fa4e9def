#pragma once
// The whole matrix of a cycle, entry by entry.

#include "whirl/core/petsc.hpp"
#include "whirl/solve/cycle/composition.hpp"

namespace whirl::solve {

/// The linearised equations of a Run as one distributed matrix, for solvers that are chosen by option and as a check on
/// everything that eliminates. Unknowns are those of CycleProblem. Blocks are asked for as dense ones: a large machine
/// pays n^2 for each pair of time points.
class CycleMatrix {
public:
  /// `first` is this rank's first interval of `total`. Collective.
  CycleMatrix(const Run& run, Eigen::Index first, Eigen::Index total);
  /// The values of a run of the same layout. Collective.
  void fill(const Run& run);
  [[nodiscard]] Mat get() const { return matrix_.get(); }

private:
  Eigen::Index first_, unknowns_;
  core::Matrix matrix_;
};

}  // namespace whirl::solve
