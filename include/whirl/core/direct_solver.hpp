#pragma once
// Sparse direct solution of assembled systems.

#include "whirl/core/petsc.hpp"

namespace whirl::core {

/// Makes `ksp` one application of MUMPS's LU. PETSc's own LU does not pivot, and rows like q' = v have no diagonal.
/// PETSc options of the solver's prefix come on top where the caller reads them.
void make_direct(KSP ksp);

/// A new direct solver on `comm` that reads PETSc options with `prefix`; the caller sets the operators. Collective.
[[nodiscard]] LinearSolver make_direct_solver(MPI_Comm comm, const char* prefix);

}  // namespace whirl::core
