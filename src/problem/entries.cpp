#include "whirl/problem/entries.hpp"

namespace whirl::problem {

using core::check;

core::Matrix Entries::matrix(MPI_Comm comm, PetscInt local) const {
  std::vector<PetscInt> rows, columns;
  for (const Place& p : places_) {
    rows.push_back(p.row);
    columns.push_back(p.column);
  }
  core::Matrix out;
  check(MatCreate(comm, out.put()));
  check(MatSetSizes(out.get(), local, local, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(out.get(), MATAIJ));
  check(MatSetPreallocationCOO(out.get(), static_cast<PetscCount>(rows.size()), rows.data(), columns.data()));
  const std::vector<double> zeros(rows.size(), 0.0);
  check(MatSetValuesCOO(out.get(), zeros.data(), INSERT_VALUES));
  return out;
}

}  // namespace whirl::problem
