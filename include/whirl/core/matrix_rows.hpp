#pragma once
// Rows of assembled matrices, and entries that ranks have of a small one.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "whirl/core/petsc.hpp"

namespace whirl::core {

/// Calls f(local row, columns, values, count) for all rows of this rank.
template <class F>
void for_rows(Mat m, F&& f) {
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(m, &begin, &end));
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(m, i, &count, &columns, &values));
    f(i - begin, columns, values, count);
    check(MatRestoreRow(m, i, &count, &columns, &values));
  }
}

/// The whole matrix where one rank has it.
[[nodiscard]] Eigen::MatrixXd dense(Mat m);

/// The sum of entries (row, column, value) that ranks have [n x n], whole on every rank. Collective.
[[nodiscard]] Eigen::SparseMatrix<double> gather_entries(MPI_Comm comm, Eigen::Index n,
                                                         const std::vector<double>& mine);

/// Number of the first row of this rank.
[[nodiscard]] PetscInt first_row(Mat m);

}  // namespace whirl::core
