#include "solve/newton/thin.hpp"

#include <algorithm>

namespace whirl::solve {

using core::check;

PetscInt first_row(Mat m) {
  PetscInt begin = 0;
  check(MatGetOwnershipRange(m, &begin, nullptr));
  return begin;
}

std::vector<PetscInt> used_columns(Mat m) {
  PetscInt n = 0;
  check(MatGetSize(m, nullptr, &n));
  std::vector<char> used(static_cast<std::size_t>(n), 0);
  for_rows(m, [&](PetscInt, const PetscInt* columns, const PetscScalar*, PetscInt count) {
    for (PetscInt k = 0; k < count; ++k) used[static_cast<std::size_t>(columns[k])] = 1;
  });
  MPI_Allreduce(MPI_IN_PLACE, used.data(), static_cast<int>(n), MPI_CHAR, MPI_MAX,
                PetscObjectComm(reinterpret_cast<PetscObject>(m)));
  std::vector<PetscInt> out;
  for (PetscInt c = 0; c < n; ++c)
    if (used[static_cast<std::size_t>(c)]) out.push_back(c);
  return out;
}

Eigen::MatrixXd thin(Mat m, const std::vector<PetscInt>& columns) {
  PetscInt local = 0;
  check(MatGetLocalSize(m, &local, nullptr));
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(local, static_cast<Eigen::Index>(columns.size()));
  for_rows(m, [&](PetscInt i, const PetscInt* at, const PetscScalar* values, PetscInt count) {
    for (PetscInt k = 0; k < count; ++k)
      out(i, std::lower_bound(columns.begin(), columns.end(), at[k]) - columns.begin()) = values[k];
  });
  return out;
}

}  // namespace whirl::solve
