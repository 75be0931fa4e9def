#include "solve/newton/port_krylov.hpp"

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;

PortKrylov::PortKrylov(const PortLayout& layout, const std::string& prefix)
    : comm_(layout.comm()), gate_(layout.comm()) {
  check(MatCreateShell(comm_, layout.local(), layout.local(), PETSC_DETERMINE, PETSC_DETERMINE, this, shell_.put()));
  check(MatShellSetOperation(shell_.get(), MATOP_MULT, reinterpret_cast<void (*)()>(shell_multiply)));
  check(KSPCreate(comm_, ksp_.put()));
  check(KSPSetOptionsPrefix(ksp_.get(), prefix.c_str()));
  check(KSPSetOperators(ksp_.get(), shell_.get(), shell_.get()));
  check(KSPSetType(ksp_.get(), KSPFGMRES));
  check(KSPSetPCSide(ksp_.get(), PC_RIGHT));
  PC pc = nullptr;
  check(KSPGetPC(ksp_.get(), &pc));
  check(PCSetType(pc, PCSHELL));
  check(PCShellSetContext(pc, this));
  check(PCShellSetApply(pc, shell_precondition));
  check(KSPSetTolerances(ksp_.get(), PETSC_DEFAULT, 1e-300, PETSC_DEFAULT, 100));
  check(KSPSetFromOptions(ksp_.get()));
}

void PortKrylov::multiply(const PortMatrix& a, Vec x, Vec y) {
  const core::ReadArray xa(x);
  const core::WriteArray ya(y);
  a.multiply(xa.data(), ya.data());
}

void PortKrylov::fail() const {
  core::agree(comm_, [] { throw core::DomainError("the linearised equations of the parts were not solved"); });
}

int PortKrylov::solve(const PortMatrix& a, PortElimination& similar, Vec rhs, Vec x, double tolerance) {
  matrix_ = &a;
  similar_ = &similar;
  check(KSPSetTolerances(ksp_.get(), tolerance, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  try {
    gate_.rethrow(KSPSolve(ksp_.get(), rhs, x));
  } catch (const core::NotConverged&) {
    fail();
  }
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp_.get(), &reason));
  if (reason < 0) fail();
  PetscInt iterations = 0;
  check(KSPGetIterationNumber(ksp_.get(), &iterations));
  return static_cast<int>(iterations);
}

PetscErrorCode PortKrylov::shell_multiply(Mat m, Vec x, Vec y) {
  void* raw = nullptr;
  PetscCall(MatShellGetContext(m, &raw));
  auto& self = *static_cast<PortKrylov*>(raw);
  return self.gate_.run([&] { multiply(*self.matrix_, x, y); });
}

PetscErrorCode PortKrylov::shell_precondition(PC pc, Vec r, Vec y) {
  void* raw = nullptr;
  PetscCall(PCShellGetContext(pc, &raw));
  auto& self = *static_cast<PortKrylov*>(raw);
  return self.gate_.run([&] { self.similar_->solve(r, y); });
}

}  // namespace whirl::solve
