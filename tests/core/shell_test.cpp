// Functions as matrices and preconditioners of PETSc.

#include "whirl/core/shell.hpp"

#include <gtest/gtest.h>

#include <memory>

using namespace whirl;

namespace {

// y = k D x with D = diag(1, 2, 3, ...), or the inverse.
core::Action diagonal(bool inverse, double k = 1) {
  return [inverse, k](Vec x, Vec y) {
    PetscInt begin = 0;
    core::check(VecGetOwnershipRange(x, &begin, nullptr));
    const core::ReadArray in(x);
    const core::WriteArray out(y);
    for (PetscInt i = 0; i < in.size(); ++i) {
      const double d = k * static_cast<double>(begin + i + 1);
      out[i] = inverse ? in[i] / d : d * in[i];
    }
  };
}

double apart(Vec a, Vec b) {
  core::Vector d = core::duplicate(a);
  core::check(VecWAXPY(d.get(), -1, a, b));
  return core::norm(d.get());
}

}  // namespace

TEST(Shell, SolvesForwardAndTransposed) {
  core::Gate gate(MPI_COMM_WORLD);
  core::Vector x = core::make_vector(MPI_COMM_WORLD, 5, PETSC_DETERMINE), b = core::duplicate(x.get()),
               y = core::duplicate(x.get());
  core::check(VecSet(x.get(), 2));
  // Told apart by a factor that no transpose has: what is asked for is what is called.
  constexpr double other = 3;
  const core::Matrix m = core::make_shell(MPI_COMM_WORLD, 5, gate, diagonal(false), diagonal(false, other));
  core::check(MatMult(m.get(), x.get(), b.get()));
  for (const bool preconditioned : {false, true}) {
    const core::Action apply = preconditioned ? diagonal(true) : core::Action(),
                       back = preconditioned ? diagonal(true, other) : core::Action();
    const core::LinearSolver ksp = core::make_krylov(m.get(), gate, {"shell_test_", KSPGMRES, 1e-12}, apply, back);
    for (const bool transposed : {false, true}) {
      gate.rethrow(transposed ? KSPSolveTranspose(ksp.get(), b.get(), y.get()) : KSPSolve(ksp.get(), b.get(), y.get()));
      EXPECT_GT(core::reason_of(ksp.get()), 0);
      if (transposed) core::check(VecScale(y.get(), other));
      EXPECT_LE(apart(x.get(), y.get()), 1e-10);
      PetscInt iterations = 0;
      core::check(KSPGetIterationNumber(ksp.get(), &iterations));
      EXPECT_EQ(iterations == 1, preconditioned);
    }
  }
}

TEST(Shell, CarriesExceptionsThroughPetsc) {
  core::Gate gate(PETSC_COMM_SELF);
  core::Vector x = core::make_vector(PETSC_COMM_SELF, 3, PETSC_DETERMINE), y = core::duplicate(x.get());
  core::check(VecSet(x.get(), 1));
  const core::Matrix m = core::make_shell(PETSC_COMM_SELF, 3, gate, [](Vec, Vec) { throw core::NotConverged("no"); });
  const core::LinearSolver ksp = core::make_krylov(m.get(), gate, {"shell_test_"}, diagonal(true));
  EXPECT_THROW(gate.rethrow(KSPSolve(ksp.get(), x.get(), y.get())), core::NotConverged);
}

// What the functions hold goes with the object that calls them, also where another preconditioner takes their place.
TEST(Shell, ForgetsItsFunctions) {
  core::Gate gate(PETSC_COMM_SELF);
  const auto held = std::make_shared<int>(1);
  const core::Action action = [held](Vec x, Vec y) { core::check(VecCopy(x, y)); };
  {
    const core::Matrix m = core::make_shell(PETSC_COMM_SELF, 3, gate, action);
    const core::LinearSolver ksp = core::make_krylov(m.get(), gate, {"shell_test_"}, action);
    EXPECT_EQ(held.use_count(), 4);
    PC pc = nullptr;
    core::check(KSPGetPC(ksp.get(), &pc));
    core::check(PCSetType(pc, PCNONE));
    EXPECT_EQ(held.use_count(), 3);
  }
  EXPECT_EQ(held.use_count(), 2);
}
