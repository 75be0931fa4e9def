#include "whirl/solve/cycle/assembled_cycle.hpp"

#include <algorithm>

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;

AssembledCycle::AssembledCycle(const Run& run, Index first, Index total) {
  const auto count = static_cast<Index>(run.intervals.size());
  const Index n = run.n, nb = run.borders, m = run.rows.front().cols() / n, unknowns = total * m * n;
  const bool last = core::rank_of(run.comm) == core::size_of(run.comm) - 1;
  const Index local = count * m * n + (last ? nb : 0);
  check(MatCreate(run.comm, matrix_.put()));
  check(MatSetSizes(matrix_.get(), static_cast<PetscInt>(local), static_cast<PetscInt>(local), PETSC_DETERMINE,
                    PETSC_DETERMINE));
  check(MatSetType(matrix_.get(), MATAIJ));
  std::vector<PetscInt> diagonal(static_cast<std::size_t>(local),
                                 static_cast<PetscInt>(std::min(local, (m + 1) * n + nb)));
  std::vector<PetscInt> off(static_cast<std::size_t>(local), static_cast<PetscInt>(n + nb));
  if (last)
    for (Index k = 0; k < nb; ++k) {
      diagonal[static_cast<std::size_t>(local - nb + k)] = static_cast<PetscInt>(local);
      off[static_cast<std::size_t>(local - nb + k)] = static_cast<PetscInt>(unknowns + nb - local);
    }
  check(MatSeqAIJSetPreallocation(matrix_.get(), 0, diagonal.data()));
  check(MatMPIAIJSetPreallocation(matrix_.get(), 0, diagonal.data(), 0, off.data()));
  const auto add = [&](Index row, Index column, const MatrixXd& block) {
    for (Index a = 0; a < block.rows(); ++a)
      for (Index b = 0; b < block.cols(); ++b)
        if (block(a, b) != 0)
          check(MatSetValue(matrix_.get(), static_cast<PetscInt>(row + a), static_cast<PetscInt>(column + b),
                            block(a, b), ADD_VALUES));
  };
  for (Index i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Index base = (first + i) * m * n, before = first + i == 0 ? unknowns - n : base - n;
    for (int j = 0; j < m; ++j) {
      add(base + j * n, before, run.intervals[k]->block(j, 0));
      for (int l = 1; l <= m; ++l) add(base + j * n, base + (l - 1) * n, run.intervals[k]->block(j, l));
    }
    add(base, unknowns, run.columns[k]);
    add(unknowns, base, run.rows[k]);
  }
  if (last) {
    add(unknowns, unknowns, run.corner);
    for (Index k = 0; k < nb; ++k)
      check(MatSetValue(matrix_.get(), static_cast<PetscInt>(unknowns + k), static_cast<PetscInt>(unknowns + k), 0.0,
                        ADD_VALUES));
  }
  check(MatAssemblyBegin(matrix_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_.get(), MAT_FINAL_ASSEMBLY));
  check(KSPCreate(run.comm, solver_.put()));
  check(KSPSetOptionsPrefix(solver_.get(), "assembled_"));
  check(KSPSetOperators(solver_.get(), matrix_.get(), matrix_.get()));
  check(KSPSetType(solver_.get(), KSPPREONLY));
  PC pc = nullptr;
  check(KSPGetPC(solver_.get(), &pc));
  check(PCSetType(pc, PCLU));
  check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  check(KSPSetFromOptions(solver_.get()));
}

void AssembledCycle::solve(Vec rhs, Vec x) {
  check(KSPSolve(solver_.get(), rhs, x));
}

}  // namespace whirl::solve
