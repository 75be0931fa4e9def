#include "whirl/core/entry_stream.hpp"

#include <algorithm>

namespace whirl::core {
namespace {

constexpr PetscInt elsewhere = PETSC_MIN_INT;

PetscInt place_in(Mat m, PetscInt row, PetscInt column) {
  PetscInt n = 0;
  const PetscInt *begin = nullptr, *columns = nullptr;
  PetscBool done = PETSC_FALSE;
  check(MatGetRowIJ(m, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &done));
  const PetscInt* const at = std::lower_bound(columns + begin[row], columns + begin[row + 1], column);
  require(at != columns + begin[row + 1] && *at == column, "an entry in the pattern of its matrix");
  const auto place = static_cast<PetscInt>(at - columns);
  check(MatRestoreRowIJ(m, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &done));
  return place;
}

}  // namespace

void EntryStream::begin(Mat m) {
  PetscBool assembled = PETSC_FALSE, several = PETSC_FALSE;
  matrix_ = own_ = m;
  others_ = nullptr;
  next_ = 0;
  check(MatAssembled(m, &assembled));
  assembled_ = assembled;
  if (!assembled_) return;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(m), MATMPIAIJ, &several));
  if (several) check(MatMPIAIJGetSeqAIJ(m, &own_, &others_, &columns_));
  check(MatGetOwnershipRange(m, &first_, &last_));
  check(MatSeqAIJGetArray(own_, &values_));
  if (others_) check(MatSeqAIJGetArray(others_, &other_values_));
}

void EntryStream::look_up(PetscInt row, PetscInt column, double value) {
  if (!assembled_) {
    check(MatSetValue(matrix_, row, column, value, ADD_VALUES));
    return;
  }
  if (next_ == places_.size()) {
    PetscInt place = elsewhere;
    if (row >= first_ && row < last_ && column >= first_ && column < last_) {
      place = place_in(own_, row - first_, column - first_);
    } else if (row >= first_ && row < last_) {
      PetscInt n = 0;
      check(MatGetSize(others_, nullptr, &n));
      place = -1 - place_in(others_, row - first_,
                            static_cast<PetscInt>(std::lower_bound(columns_, columns_ + n, column) - columns_));
    }
    places_.push_back(place);
  }
  const PetscInt place = places_[next_++];
  if (place >= 0)
    values_[place] += value;
  else if (place != elsewhere)
    other_values_[-1 - place] += value;
  else
    check(MatSetValue(matrix_, row, column, value, ADD_VALUES));
}

void EntryStream::end() {
  if (assembled_) {
    check(MatSeqAIJRestoreArray(own_, &values_));
    if (others_) check(MatSeqAIJRestoreArray(others_, &other_values_));
  }
  check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
}

}  // namespace whirl::core
