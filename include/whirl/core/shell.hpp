#pragma once
// Matrices and preconditioners that are functions: PETSc's shells.

#include <functional>

#include "whirl/core/gate.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::core {

/// y from x, vectors of one layout. What it throws on several ranks is agreed.
using Action = std::function<void(Vec x, Vec y)>;

/// A square matrix with `local` rows on this rank that is known by its products, and by those of its transpose unless
/// these are empty. Exceptions leave PETSc through `gate`, which outlives the matrix. Collective on `comm`.
[[nodiscard]] Matrix make_shell(MPI_Comm comm, PetscInt local, Gate& gate, Action multiply, Action transposed = {});

/// Makes `pc` the function `apply`, and `transposed` with the transpose; `gate` likewise.
void set_shell(PC pc, Gate& gate, Action apply, Action transposed = {});

/// Solves end at the relative residual `tolerance` or after `most` iterations; GMRES starts anew after `restart`. PETSc
/// options with `prefix` come on top.
struct KrylovOptions {
  const char* prefix;
  KSPType type = KSPGMRES;
  double tolerance = 1e-5;
  PetscInt most = 100, restart = 30;
};
/// A Krylov method for `matrix`, preconditioned from the right by a function, or by none where `apply` is empty; `gate`
/// outlives it.
[[nodiscard]] LinearSolver make_krylov(Mat matrix, Gate& gate, const KrylovOptions& options, Action apply,
                                       Action transposed = {});

/// Why the last solve ended: negative if it did not converge.
[[nodiscard]] KSPConvergedReason reason_of(KSP ksp);

}  // namespace whirl::core
