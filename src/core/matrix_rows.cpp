#include "whirl/core/matrix_rows.hpp"

#include <algorithm>
#include <numeric>

namespace whirl::core {

PetscInt first_row(Mat m) {
  PetscInt begin = 0;
  check(MatGetOwnershipRange(m, &begin, nullptr));
  return begin;
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
