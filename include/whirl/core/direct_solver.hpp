#pragma once
// Sparse direct solution of assembled systems.

#include "whirl/core/petsc.hpp"

namespace whirl::core {

/// Up to so many real unknowns on one rank KLU beats MUMPS, whose nested dissection wins beyond.
inline constexpr PetscInt most_by_klu = 20000;

/// Makes `ksp` one application of an LU with pivots, of a matrix of so many unknowns: by KLU on one rank, else by
/// MUMPS. PETSc's own LU does not pivot, and rows like q' = v have no diagonal. PETSc options of the solver's prefix
/// come on top where the caller reads them.
void make_direct(KSP ksp, PetscInt unknowns = PETSC_MAX_INT);

/// A new direct solver on `comm` that reads PETSc options with `prefix`; the caller sets the operators. Collective.
[[nodiscard]] LinearSolver make_direct_solver(MPI_Comm comm, const char* prefix);

}  // namespace whirl::core
