#pragma once
// This rank's part of an assembled matrix as PETSc holds it.

#include "whirl/core/petsc.hpp"

namespace whirl::solve {

/// This rank's rows: columns of its own rows, then those of others.
struct Stored {
  Mat own = nullptr, others = nullptr;
  const PetscInt* columns = nullptr;  // of `others`: numbers in the matrix

  explicit Stored(Mat a) : own(a) {
    PetscBool several = PETSC_FALSE;
    core::check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(a), MATMPIAIJ, &several));
    if (several) core::check(MatMPIAIJGetSeqAIJ(a, &own, &others, &columns));
  }
  /// Entries in columns of its own rows.
  [[nodiscard]] PetscInt entries() const {
    MatInfo info;
    core::check(MatGetInfo(own, MAT_LOCAL, &info));
    return static_cast<PetscInt>(info.nz_used);
  }
};

}  // namespace whirl::solve
