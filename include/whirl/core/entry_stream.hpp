#pragma once
// The same entries of matrices of one pattern, over and over.

#include <vector>

#include "whirl/core/petsc.hpp"

namespace whirl::core {

/// Adds to the same entries of AIJ matrices of one pattern in the same order in every pass. Their places are looked up
/// in the first pass; after it an entry costs an addition instead of a search. Rows of other ranks go through PETSc.
///
///     stream.begin(m);  stream.add(row, column, value);  ...  stream.end();
class EntryStream {
public:
  /// A matrix that was not assembled yet has no places: its entries are set by PETSc.
  void begin(Mat m);
  void add(PetscInt row, PetscInt column, double value) {
    if (next_ < places_.size() && places_[next_] >= 0) {
      values_[places_[next_++]] += value;
      return;
    }
    look_up(row, column, value);
  }
  /// Assembles. Collective.
  void end();

private:
  void look_up(PetscInt row, PetscInt column, double value);
  Mat matrix_ = nullptr, own_ = nullptr, others_ = nullptr;
  bool assembled_ = false;
  PetscInt first_ = 0, last_ = 0;
  const PetscInt* columns_ = nullptr;  // of others_
  PetscScalar *values_ = nullptr, *other_values_ = nullptr;
  std::vector<PetscInt> places_;  // in the values of this rank's own columns; -1 - place in those of others, below that
                                  // PETSc's
  std::size_t next_ = 0;
};

}  // namespace whirl::core
