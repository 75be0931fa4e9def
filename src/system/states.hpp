#pragma once
// Entries of matrices of states, gathered before the room in their rows is known.

#include <vector>

#include "whirl/core/petsc.hpp"

namespace whirl::system {

/// Entries of this rank's rows of a matrix of the pairs (q, v) of all coordinates. Those at one place add up.
class StateEntries {
public:
  void add(PetscInt row, PetscInt column, double value) { entries_.push_back({row, column, value}); }
  /// Entry (i, j) of this rank's rows of a matrix of coordinates at (2 i, 2 j + rate).
  void add(Mat m, PetscInt rate);
  /// Entries of a matrix of states as they are.
  void add(Mat m);
  /// Those of 2 `coordinates` rows here, zeros too. Collective.
  [[nodiscard]] core::Matrix matrix(MPI_Comm comm, PetscInt coordinates) const;

private:
  struct Entry {
    PetscInt row, column;
    double value;
  };
  std::vector<Entry> entries_;
};

/// Calls take(row, column, value) for the entries of this rank's rows.
template <class Take>
void for_entries(Mat m, const Take& take) {
  PetscInt begin = 0, end = 0;
  core::check(MatGetOwnershipRange(m, &begin, &end));
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt n = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    core::check(MatGetRow(m, i, &n, &columns, &values));
    for (PetscInt e = 0; e < n; ++e) take(i, columns[e], values[e]);
    core::check(MatRestoreRow(m, i, &n, &columns, &values));
  }
}

}  // namespace whirl::system
