#include "states.hpp"

#include <algorithm>

namespace whirl::system {

void StateEntries::add(Mat m, PetscInt rate) {
  for_entries(m, [&](PetscInt i, PetscInt j, double value) { add(2 * i, 2 * j + rate, value); });
}

void StateEntries::add(Mat m) {
  for_entries(m, [&](PetscInt i, PetscInt j, double value) { add(i, j, value); });
}

core::Matrix StateEntries::matrix(MPI_Comm comm, PetscInt coordinates) const {
  const PetscInt local = 2 * coordinates;
  PetscInt end = 0, size = 0;
  MPI_Scan(&local, &end, 1, MPIU_INT, MPI_SUM, comm);
  MPI_Allreduce(&local, &size, 1, MPIU_INT, MPI_SUM, comm);
  const PetscInt begin = end - local;
  std::vector<PetscInt> count(static_cast<std::size_t>(std::max<PetscInt>(local, 1)), 0);
  for (const Entry& e : entries_) ++count[static_cast<std::size_t>(e.row - begin)];
  for (PetscInt& c : count) c = std::min(c, size);
  core::Matrix out = core::make_matrix(comm, local, std::move(count));
  for (const Entry& e : entries_) core::check(MatSetValue(out.get(), e.row, e.column, e.value, ADD_VALUES));
  core::check(MatAssemblyBegin(out.get(), MAT_FINAL_ASSEMBLY));
  core::check(MatAssemblyEnd(out.get(), MAT_FINAL_ASSEMBLY));
  return out;
}

}  // namespace whirl::system
