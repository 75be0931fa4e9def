#include "whirl/core/direct_solver.hpp"

namespace whirl::core {

void make_direct(KSP ksp, PetscInt unknowns) {
  PC pc = nullptr;
  const bool few = unknowns <= most_by_klu && size_of(PetscObjectComm(reinterpret_cast<PetscObject>(ksp))) == 1;
  check(KSPSetType(ksp, KSPPREONLY));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCLU));
  check(PCFactorSetMatSolverType(pc, few ? MATSOLVERKLU : MATSOLVERMUMPS));
}

LinearSolver make_direct_solver(MPI_Comm comm, const char* prefix) {
  LinearSolver ksp;
  check(KSPCreate(comm, ksp.put()));
  check(KSPSetOptionsPrefix(ksp.get(), prefix));
  make_direct(ksp.get());
  check(KSPSetFromOptions(ksp.get()));
  return ksp;
}

}  // namespace whirl::core
