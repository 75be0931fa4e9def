#include "whirl/core/gate.hpp"

#include <gtest/gtest.h>

#include <new>

using namespace whirl::core;

namespace {

struct Problem {
  Gate gate{MPI_COMM_WORLD};
  int throw_on_rank = -1;
  bool domain = false;
  bool only_far = false;  // throw only where x > 2, so that a shorter step succeeds
  double last_x = 0;
};

// F(x) = x^3 - 8 in every entry, with a throw on one rank as asked.
PetscErrorCode residual(SNES snes, Vec x, Vec f, void* context) {
  auto& p = *static_cast<Problem*>(context);
  PetscErrorCode code = p.gate.run([&] {
    ReadArray xa(x);
    agree(MPI_COMM_WORLD, [&] {
      if (rank_of(MPI_COMM_WORLD) != p.throw_on_rank) return;
      if (p.only_far && xa[0] <= 3.0) return;
      if (p.domain) throw DomainError("film thickness is negative");
      throw Error("rank's own failure");
    });
    WriteArray fa(f);
    for (PetscInt i = 0; i < xa.size(); ++i) fa[i] = xa[i] * xa[i] * xa[i] - 8;
  });
  if (p.gate.domain_error()) return SNESSetFunctionDomainError(snes);
  return code;
}

PetscErrorCode jacobian(SNES, Vec x, Mat j, Mat, void*) {
  ReadArray xa(x);
  PetscInt begin = 0;
  check(VecGetOwnershipRange(x, &begin, nullptr));
  for (PetscInt i = 0; i < xa.size(); ++i)
    check(MatSetValue(j, begin + i, begin + i, 3 * xa[i] * xa[i], INSERT_VALUES));
  check(MatAssemblyBegin(j, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(j, MAT_FINAL_ASSEMBLY));
  return 0;
}

SNESConvergedReason solve(Problem& p, double start, double& answer) {
  Vector x = make_vector(MPI_COMM_WORLD, 2, PETSC_DETERMINE), f = duplicate(x.get());
  check(VecSet(x.get(), start));
  Matrix j;
  check(MatCreateAIJ(MPI_COMM_WORLD, 2, 2, PETSC_DETERMINE, PETSC_DETERMINE, 1, nullptr, 0, nullptr, j.put()));
  NonlinearSolver snes;
  check(SNESCreate(MPI_COMM_WORLD, snes.put()));
  check(SNESSetFunction(snes.get(), f.get(), residual, &p));
  check(SNESSetJacobian(snes.get(), j.get(), j.get(), jacobian, &p));
  SNESLineSearch search = nullptr;
  check(SNESGetLineSearch(snes.get(), &search));
  check(SNESLineSearchSetType(search, SNESLINESEARCHBT));
  p.gate.rethrow(SNESSolve(snes.get(), nullptr, x.get()));
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  check(SNESGetConvergedReason(snes.get(), &reason));
  answer = ReadArray(x.get())[0];
  return reason;
}

}  // namespace

TEST(Gate, SolvesWhenNothingFails) {
  Problem p;
  double x = 0;
  EXPECT_GT(solve(p, 1.0, x), 0);
  EXPECT_NEAR(x, 2.0, 1e-8);
}

TEST(Gate, ErrorOnOneRankIsRaisedOnAllWithItsText) {
  for (int r = 0; r < size_of(MPI_COMM_WORLD); ++r) {
    Problem p;
    p.throw_on_rank = r;
    double x = 0;
    try {
      solve(p, 1.0, x);
      FAIL() << "no error was raised";
    } catch (const Error& e) {
      EXPECT_STREQ(e.what(), "rank's own failure");
      EXPECT_TRUE(e.agreed());
    }
  }
}

TEST(Gate, DomainErrorOnOneRankShortensTheStep) {
  Problem p;
  p.throw_on_rank = size_of(MPI_COMM_WORLD) - 1;
  p.domain = p.only_far = true;
  double x = 0;
  EXPECT_GT(solve(p, 0.5, x), 0);  // a full Newton step from 0.5 lands at 11
  EXPECT_NEAR(x, 2.0, 1e-8);
  EXPECT_EQ(p.gate.domain_text(), "film thickness is negative");
}

TEST(Agree, TheGravestErrorWins) {
  const int n = size_of(MPI_COMM_WORLD);
  try {
    agree(MPI_COMM_WORLD, [&] {
      if (rank_of(MPI_COMM_WORLD) == n - 1) throw InputError("deck");
      throw DomainError("film");
    });
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "deck");
  }
}

// An iteration whose end each rank would see at another step: rank 0's counts, and all ranks take part in its steps.
TEST(Lead, OneRankDecidesForAll) {
  const int rank = rank_of(MPI_COMM_WORLD), size = size_of(MPI_COMM_WORLD);
  int parts = 0;
  double sum = 0, last = 0;
  lead(
      MPI_COMM_WORLD, 0,
      [&](const auto& together) {
        const double perturbed = 1e-3 * rank;  // nobody's business but the leader's
        for (double left = 1 + perturbed; left > 0.1; left /= 2) {
          last = left;
          together();
        }
      },
      [&] {
        ++parts;
        const double mine = 1;
        MPI_Allreduce(&mine, &sum, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
      });
  EXPECT_EQ(parts, 4);
  EXPECT_EQ(sum, size);
  EXPECT_EQ(last, rank == 0 ? 0.125 : 0);
  share(MPI_COMM_WORLD, &last, 1);
  EXPECT_EQ(last, 0.125);
}

TEST(Lead, ErrorsEndTheWorkOnAllRanks) {
  const int rank = rank_of(MPI_COMM_WORLD), size = size_of(MPI_COMM_WORLD);
  const auto collective = [&](int failing) {
    return [=] {
      agree(MPI_COMM_WORLD, [&] {
        if (rank == failing) throw NotConverged("a part");
      });
    };
  };
  EXPECT_THROW(lead(
                   MPI_COMM_WORLD, size - 1, [](const auto& together) { together(); }, collective(0)),
               NotConverged);
  EXPECT_THROW(lead(
                   MPI_COMM_WORLD, size - 1, [](const auto&) { throw DomainError("the leader's"); }, collective(-1)),
               DomainError);
}

TEST(Agree, MemoryThatRunsOutOnOneRankIsNoMistakeOfOurs) {
  try {
    agree(MPI_COMM_WORLD, [&] {
      if (rank_of(MPI_COMM_WORLD) == 0) throw std::bad_alloc();
    });
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), out_of_memory);
    EXPECT_EQ(e.exit(), Exit::failure);
    EXPECT_TRUE(e.agreed());
  }
}

TEST(Check, PetscFailureCarriesItsText) {
  Vector v = make_vector(MPI_COMM_WORLD, 2, PETSC_DETERMINE), w = make_vector(MPI_COMM_WORLD, 3, PETSC_DETERMINE);
  try {
    check(VecAXPY(v.get(), 1.0, w.get()));
    FAIL();
  } catch (const LibraryError& e) {
    EXPECT_NE(std::string(e.what()).find("ncompatible"), std::string::npos) << e.what();
  }
}
