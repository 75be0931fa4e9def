#pragma once
// Distributed PETSc objects as dense Eigen copies on every rank, for tests of small systems.

#include <Eigen/Core>

#include "whirl/core/petsc.hpp"

namespace whirl::test {

inline Eigen::VectorXd dense(Vec v) {
  core::Vector all;
  core::Scatter gather;
  core::check(VecScatterCreateToAll(v, gather.put(), all.put()));
  core::check(VecScatterBegin(gather.get(), v, all.get(), INSERT_VALUES, SCATTER_FORWARD));
  core::check(VecScatterEnd(gather.get(), v, all.get(), INSERT_VALUES, SCATTER_FORWARD));
  const core::ReadArray a(all.get());
  return Eigen::Map<const Eigen::VectorXd>(a.data(), a.size());
}

inline Eigen::MatrixXd dense(Mat m) {
  PetscInt rows = 0, columns = 0, begin = 0, end = 0;
  core::check(MatGetSize(m, &rows, &columns));
  core::check(MatGetOwnershipRange(m, &begin, &end));
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(rows, columns);
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt n = 0;
    const PetscInt* at = nullptr;
    const PetscScalar* values = nullptr;
    core::check(MatGetRow(m, i, &n, &at, &values));
    for (PetscInt k = 0; k < n; ++k) a(i, at[k]) = values[k];
    core::check(MatRestoreRow(m, i, &n, &at, &values));
  }
  MPI_Allreduce(MPI_IN_PLACE, a.data(), static_cast<int>(a.size()), MPI_DOUBLE, MPI_SUM,
                PetscObjectComm(reinterpret_cast<PetscObject>(m)));
  return a;
}

}  // namespace whirl::test
