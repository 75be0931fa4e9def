#include "solve/newton/port_krylov.hpp"

#include <fmt/format.h>

#include <string>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/core/shell.hpp"

namespace whirl::solve {

using core::check;

PortKrylov::PortKrylov(const PortLayout& layout, const char* prefix)
    : comm_(layout.comm()), asked_(core::plan::tolerance(prefix)), gate_(layout.comm()) {
  shell_ = core::make_shell(comm_, layout.local(), gate_, [this](Vec x, Vec y) { multiply(*matrix_, x, y); });
  ksp_ = core::make_krylov(shell_.get(), gate_, {prefix, KSPFGMRES}, [this](Vec r, Vec y) { similar_->solve(r, y); });
}

void PortKrylov::multiply(const PortMatrix& a, Vec x, Vec y) {
  const core::ReadArray xa(x);
  const core::WriteArray ya(y);
  a.multiply(xa.data(), ya.data());
}

void PortKrylov::fail(const std::string& why) const {
  core::agree(comm_, [&] { throw core::DomainError("the linearised equations of the parts were not solved: " + why); });
}

int PortKrylov::solve(const PortMatrix& a, PortElimination& similar, Vec rhs, Vec x, double tolerance) {
  matrix_ = &a;
  similar_ = &similar;
  check(KSPSetTolerances(ksp_.get(), asked_.value_or(tolerance), PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  try {
    gate_.rethrow(KSPSolve(ksp_.get(), rhs, x));
  } catch (const core::NotConverged& error) {
    fail(error.what());
  }
  PetscInt iterations = 0;
  check(KSPGetIterationNumber(ksp_.get(), &iterations));
  if (core::reason_of(ksp_.get()) < 0) {
    PetscReal left = 0, from = 0;
    check(KSPGetResidualNorm(ksp_.get(), &left));
    check(VecNorm(rhs, NORM_2, &from));
    fail(fmt::format("FGMRES ended after {} iterations at a relative residual of {:.1e}", iterations, left / from));
  }
  return static_cast<int>(iterations);
}

}  // namespace whirl::solve
