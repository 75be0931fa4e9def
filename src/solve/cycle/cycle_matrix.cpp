#include "solve/cycle/cycle_matrix.hpp"

#include <algorithm>

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;

CycleMatrix::CycleMatrix(const Run& run, Index first, Index total) : first_(first) {
  const auto count = static_cast<Index>(run.intervals.size());
  const Index n = run.n, nb = run.borders, m = run.rows.front().cols() / n;
  unknowns_ = total * m * n;
  const bool last = core::rank_of(run.comm) == core::size_of(run.comm) - 1;
  const Index local = count * m * n + (last ? nb : 0);
  // Each point sees its interval, the end of the one before, and the border.
  std::vector<PetscInt> entries(static_cast<std::size_t>(local),
                                static_cast<PetscInt>(std::min(unknowns_, (m + 1) * n) + nb));
  if (last) std::fill(entries.end() - nb, entries.end(), static_cast<PetscInt>(unknowns_ + nb));
  matrix_ = core::make_matrix(run.comm, static_cast<PetscInt>(local), std::move(entries));
  // An entry that is zero now may not stay so: contact, cavitation.
  check(MatSetOption(matrix_.get(), MAT_NEW_NONZERO_LOCATION_ERR, PETSC_FALSE));
  check(MatSetOption(matrix_.get(), MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  fill(run);
}

void CycleMatrix::fill(const Run& run) {
  const Index n = run.n, nb = run.borders, m = run.rows.front().cols() / n;
  const auto add = [&](Index row, Index column, const MatrixXd& block) {
    for (Index a = 0; a < block.rows(); ++a)
      for (Index b = 0; b < block.cols(); ++b)
        if (block(a, b) != 0)
          check(MatSetValue(matrix_.get(), static_cast<PetscInt>(row + a), static_cast<PetscInt>(column + b),
                            block(a, b), ADD_VALUES));
  };
  check(MatZeroEntries(matrix_.get()));
  for (std::size_t k = 0; k < run.intervals.size(); ++k) {
    const Index i = first_ + static_cast<Index>(k), base = i * m * n, before = i == 0 ? unknowns_ - n : base - n;
    for (int j = 0; j < m; ++j) {
      add(base + j * n, before, run.intervals[k]->block(j, 0));
      for (int l = 1; l <= m; ++l) add(base + j * n, base + (l - 1) * n, run.intervals[k]->block(j, l));
    }
    add(base, unknowns_, run.columns[k]);
    add(unknowns_, base, run.rows[k]);
  }
  if (core::rank_of(run.comm) == core::size_of(run.comm) - 1) {
    add(unknowns_, unknowns_, run.corner);
    // Direct solvers want every diagonal entry to be there.
    for (Index k = 0; k < nb; ++k)
      check(MatSetValue(matrix_.get(), static_cast<PetscInt>(unknowns_ + k), static_cast<PetscInt>(unknowns_ + k), 0.0,
                        ADD_VALUES));
  }
  check(MatAssemblyBegin(matrix_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_.get(), MAT_FINAL_ASSEMBLY));
}

}  // namespace whirl::solve
