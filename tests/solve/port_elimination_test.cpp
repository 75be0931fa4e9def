// Elimination of the parts of a machine on their ports, and products in their blocks, against dense matrices.

#include "solve/newton/port_krylov.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "support/dense.hpp"

using namespace whirl;
using core::check;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// A hub of 5 with a border behind everything, two films of 6 and 9 states that are cut where the ranks want it, one of
// them with two fields, and one that only the last rank has. Each sees two unknowns of the hub, one of which all see,
// and the border.
struct Machine {
  static constexpr PetscInt hub = 5, n = 5 + 6 + 9 + 4 + 1;
  PetscInt local = 0, first = 0;
  std::vector<problem::Field> fields;
  core::Matrix a;

  Machine() {
    const int rank = core::rank_of(MPI_COMM_WORLD), size = core::size_of(MPI_COMM_WORLD);
    const auto cut = [&](int r) -> PetscInt { return r == 0 ? 0 : r == size ? n : 5 + 15 * r / size; };
    first = cut(rank);
    local = cut(rank + 1) - first;
    const auto part = [&](const char* name, PetscInt from, PetscInt to, const char* quantity = "") {
      from = std::clamp<PetscInt>(from - first, 0, local);
      to = std::clamp<PetscInt>(to - first, 0, local);
      fields.push_back({name, from, to, quantity});
    };
    part("machine", 0, 5);
    part("one", 5, 11);
    part("two", 11, 14);
    part("two", 14, 20, "other");
    part("three", 20, 24);
    check(MatCreateAIJ(MPI_COMM_WORLD, local, local, n, n, n, nullptr, n, nullptr, a.put()));
    fill(1);
  }

  static double entry(PetscInt i, PetscInt j) { return std::sin(1.7 * i + 0.9 * j + 0.3 * i * j); }
  static int part_of(PetscInt k) { return k < 5 || k == 24 ? 0 : k < 11 ? 1 : k < 20 ? 2 : 3; }
  void fill(double factor) {
    for (PetscInt i = first; i < first + local; ++i)
      for (PetscInt j = 0; j < n; ++j) {
        const int p = part_of(i), q = part_of(j);
        const bool port = (q == 0 && p > 0 && (j == 0 || j == p || j == 24)) ||
                          (p == 0 && q > 0 && (i == 1 || i == q + 1 || i == 24));
        double value = 0;
        if (p == q) value = factor * entry(i, j) + (i == j ? 3 : 0);
        if (port) value = entry(i, j);
        if (value != 0) check(MatSetValue(a.get(), i, j, value, INSERT_VALUES));
      }
    check(MatAssemblyBegin(a.get(), MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(a.get(), MAT_FINAL_ASSEMBLY));
  }
};

}  // namespace

TEST(PortElimination, SolvesLikeTheWholeMatrix) {
  Machine m;
  solve::PortElimination elimination(m.fields);
  core::Vector b = core::make_vector(MPI_COMM_WORLD, m.local, PETSC_DETERMINE), x = core::duplicate(b.get());
  {
    const core::WriteArray values(b.get());
    for (PetscInt i = 0; i < values.size(); ++i) values[i] = std::cos(2.0 * static_cast<double>(m.first + i));
  }
  // The second time with other values in the same places.
  for (const double factor : {1.0, -0.6}) {
    m.fill(factor);
    elimination.factorise(m.a.get());
    const MatrixXd whole = test::dense(m.a.get());
    const VectorXd rhs = test::dense(b.get());
    elimination.solve(b.get(), x.get());
    EXPECT_LT((whole * test::dense(x.get()) - rhs).norm(), 1e-11);
    elimination.solve_transposed(b.get(), x.get());
    EXPECT_LT((whole.transpose() * test::dense(x.get()) - rhs).norm(), 1e-11);
  }
}

TEST(PortMatrix, MultipliesLikeTheWholeMatrix) {
  Machine m;
  solve::PortMatrix blocks(std::make_shared<const solve::PortLayout>(m.a.get(), m.fields));
  core::Vector v = core::make_vector(MPI_COMM_WORLD, m.local, PETSC_DETERMINE), y = core::duplicate(v.get());
  {
    const core::WriteArray values(v.get());
    for (PetscInt i = 0; i < values.size(); ++i) values[i] = std::cos(2.0 * static_cast<double>(m.first + i));
  }
  for (const double factor : {1.0, -0.6}) {
    m.fill(factor);
    blocks.take(m.a.get());
    solve::PortKrylov::multiply(blocks, v.get(), y.get());
    EXPECT_LT((test::dense(m.a.get()) * test::dense(v.get()) - test::dense(y.get())).norm(), 1e-13);
  }
}

// At a fold the machine's own matrix is singular, the bordered one is not.
TEST(PortElimination, TheBorderMayHoldTheHubUp) {
  Machine m;
  // Row 0 of the hub sees no part, and vanishes but for its border.
  if (m.first == 0) {
    for (PetscInt j = 0; j < 5; ++j) check(MatSetValue(m.a.get(), 0, j, 0, INSERT_VALUES));
    check(MatSetValue(m.a.get(), 0, 24, 1, INSERT_VALUES));
  }
  check(MatAssemblyBegin(m.a.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(m.a.get(), MAT_FINAL_ASSEMBLY));
  const MatrixXd whole = test::dense(m.a.get());
  ASSERT_EQ(whole.topLeftCorner(24, 24).fullPivLu().rank(), 23);
  ASSERT_EQ(whole.fullPivLu().rank(), 25);
  solve::PortElimination elimination(m.fields);
  elimination.factorise(m.a.get());
  core::Vector b = core::make_vector(MPI_COMM_WORLD, m.local, PETSC_DETERMINE), x = core::duplicate(b.get());
  check(VecSet(b.get(), 1));
  elimination.solve(b.get(), x.get());
  EXPECT_LT((whole * test::dense(x.get()) - VectorXd::Ones(Machine::n)).norm(), 1e-10);
}
