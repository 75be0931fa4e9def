#include "whirl/core/matrix_rows.hpp"

#include <algorithm>
#include <numeric>

namespace whirl::core {

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

Eigen::SparseMatrix<double> gather_matrix(Mat m) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(m));
  PetscInt n = 0;
  check(MatGetSize(m, &n, nullptr));
  std::vector<double> mine;  // row, column, value
  const PetscInt first = first_row(m);
  for_rows(m, [&](PetscInt i, const PetscInt* columns, const PetscScalar* values, PetscInt count) {
    for (PetscInt k = 0; k < count; ++k)
      mine.insert(mine.end(), {static_cast<double>(first + i), static_cast<double>(columns[k]), values[k]});
  });
  return gather_entries(comm, n, mine);
}

Eigen::SparseMatrix<double> gather_entries(MPI_Comm comm, Eigen::Index n, const std::vector<double>& mine) {
  const auto size = static_cast<std::size_t>(size_of(comm));
  const int here = static_cast<int>(mine.size());
  std::vector<int> counts(size), begins(size);
  MPI_Allgather(&here, 1, MPI_INT, counts.data(), 1, MPI_INT, comm);
  std::exclusive_scan(counts.begin(), counts.end(), begins.begin(), 0);
  std::vector<double> all(static_cast<std::size_t>(begins.back() + counts.back()));
  MPI_Allgatherv(mine.data(), here, MPI_DOUBLE, all.data(), counts.data(), begins.data(), MPI_DOUBLE, comm);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < all.size(); k += 3)
    entries.emplace_back(static_cast<int>(all[k]), static_cast<int>(all[k + 1]), all[k + 2]);
  Eigen::SparseMatrix<double> out(n, n);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

Eigen::MatrixXd dense(Mat m) {
  PetscInt rows = 0, width = 0;
  check(MatGetSize(m, &rows, &width));
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows, width);
  for_rows(m, [&](PetscInt i, const PetscInt* columns, const PetscScalar* values, PetscInt count) {
    for (PetscInt k = 0; k < count; ++k) out(i, columns[k]) = values[k];
  });
  return out;
}

}  // namespace whirl::core
