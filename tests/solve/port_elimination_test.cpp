// Elimination of the parts of a machine on their ports, and products in their blocks, against dense matrices.

#include "solve/newton/port_krylov.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "support/dense.hpp"
#include "support/petsc_options.hpp"
#include "whirl/core/error.hpp"

using namespace whirl;
using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// A hub of 5 with a border behind everything, two films of 6 and 9 states that are cut where the ranks want it, one of
// them with two fields, and one that only the last rank has. Each sees two unknowns of the hub, one of which all see,
// and the border. Without the border the hub stands on one rank.
struct Machine {
  static constexpr PetscInt hub = 5;
  PetscInt n, local = 0, first = 0;
  std::vector<problem::Field> fields;
  core::Matrix a;

  explicit Machine(bool border = true) : n(5 + 6 + 9 + 4 + (border ? 1 : 0)) {
    const int rank = core::rank_of(MPI_COMM_WORLD), size = core::size_of(MPI_COMM_WORLD);
    const auto cut = [&](int r) -> PetscInt { return r == 0 ? 0 : r == size ? n : 5 + 15 * r / size; };
    first = cut(rank);
    local = cut(rank + 1) - first;
    const auto part = [&](const char* name, PetscInt from, PetscInt to, const char* quantity = "") {
      from = std::clamp<PetscInt>(from - first, 0, local);
      to = std::clamp<PetscInt>(to - first, 0, local);
      const bool again = !fields.empty() && fields.back().name == name;
      const int number = fields.empty() ? 0 : fields.back().part + (again ? 0 : 1);
      fields.push_back({.name = name, .begin = from, .end = to, .quantity = quantity, .part = number});
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
    assemble();
  }
  void assemble() {
    check(MatAssemblyBegin(a.get(), MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(a.get(), MAT_FINAL_ASSEMBLY));
  }
  // Row 0 of the hub, which sees no part, vanishes but for its border.
  void let_go(double border) {
    for (PetscInt j = 0; j < hub && first == 0; ++j) check(MatSetValue(a.get(), 0, j, 0, INSERT_VALUES));
    if (first == 0 && n > 24) check(MatSetValue(a.get(), 0, 24, border, INSERT_VALUES));
    assemble();
  }
};

core::Vector some(const Machine& m) {
  core::Vector b = core::make_vector(MPI_COMM_WORLD, m.local, PETSC_DETERMINE);
  const core::WriteArray values(b.get());
  for (PetscInt i = 0; i < values.size(); ++i) values[i] = std::cos(2.0 * static_cast<double>(m.first + i));
  return b;
}

// The parts as if no rank saw the rows of others.
class OfOwnRows : public problem::PartInverse {
public:
  explicit OfOwnRows(const Machine& m) {
    const MatrixXd whole = test::dense(m.a.get());
    std::vector<Index> rows;
    for (PetscInt i = m.first; i < m.first + m.local; ++i)
      if (Machine::part_of(i) != 0) rows.push_back(i);
    if (!rows.empty()) lu_.compute(whole(rows, rows));
  }
  void set(const problem::Point&, double, double) override {}
  void apply(std::span<const double> r, std::span<double> y) override {
    const Index n = lu_.cols();
    if (n == 0) return;
    const auto columns = static_cast<Index>(r.size()) / n;
    Eigen::Map<MatrixXd>(y.data(), n, columns) = lu_.solve(Eigen::Map<const MatrixXd>(r.data(), n, columns));
  }

private:
  Eigen::PartialPivLU<MatrixXd> lu_;
};

// Nobody may be left behind: every rank gets an error on which all agree.
template <class Error, class Work>
void expect_agreed(Work&& work) {
  try {
    work();
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_TRUE(e.agreed()) << e.what();
  }
}

}  // namespace

TEST(PortElimination, SolvesLikeTheWholeMatrix) {
  Machine m;
  solve::PortElimination elimination(m.fields);
  core::Vector b = some(m), x = core::duplicate(b.get());
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
  core::Vector v = some(m), y = core::duplicate(v.get());
  for (const double factor : {1.0, -0.6}) {
    m.fill(factor);
    blocks.take(m.a.get());
    solve::PortKrylov::multiply(blocks, v.get(), y.get());
    EXPECT_LT((test::dense(m.a.get()) * test::dense(v.get()) - test::dense(y.get())).norm(), 1e-13);
  }
}

// Each rank tells what its parts do to the hub, wherever the rows of the hub stand, and some entries of every block in
// two pieces.
TEST(PortMatrix, TakesAListOfEntriesToo) {
  Machine m;
  const MatrixXd whole = test::dense(m.a.get());
  problem::Entries entries;
  const auto here = [&](PetscInt k) { return k >= m.first && k < m.first + m.local; };
  const auto list = [&](double factor) {
    entries.begin();
    for (PetscInt j = 0; j < m.n; ++j)
      for (PetscInt i = 0; i < m.n; ++i) {
        const bool of_part = Machine::part_of(i) == 0 && Machine::part_of(j) != 0;
        if (whole(i, j) == 0 || !here(of_part ? j : i)) continue;
        const bool twice = (i + j) % 3 == 0;
        for (int k = 0; k < (twice ? 2 : 1); ++k) entries.add(i, j, factor * whole(i, j) / (twice ? 2 : 1));
      }
  };
  list(1);
  solve::PortMatrix blocks(
      std::make_shared<const solve::PortLayout>(MPI_COMM_WORLD, m.local, m.fields, entries.places()));
  core::Vector v = some(m), y = core::duplicate(v.get()), rows = core::duplicate(v.get()),
               columns = core::duplicate(v.get());
  check(VecSetRandom(rows.get(), nullptr));
  check(VecSetRandom(columns.get(), nullptr));
  for (const double factor : {1.0, -0.6}) {
    list(factor);
    blocks.take(entries.values());
    solve::PortKrylov::multiply(blocks, v.get(), y.get());
    EXPECT_LT((factor * whole * test::dense(v.get()) - test::dense(y.get())).norm(), 1e-13);
    blocks.scale(rows.get(), columns.get());
    solve::PortKrylov::multiply(blocks, v.get(), y.get());
    const MatrixXd scaled =
        factor * test::dense(rows.get()).asDiagonal() * whole * test::dense(columns.get()).asDiagonal();
    EXPECT_LT((scaled * test::dense(v.get()) - test::dense(y.get())).norm(), 1e-13);
  }
}

// At a fold the machine's own matrix is singular, the bordered one is not.
TEST(PortElimination, TheBorderMayHoldTheHubUp) {
  Machine m;
  m.let_go(1);
  const MatrixXd whole = test::dense(m.a.get());
  ASSERT_EQ(whole.topLeftCorner(24, 24).fullPivLu().rank(), 23);
  ASSERT_EQ(whole.fullPivLu().rank(), 25);
  solve::PortElimination elimination(m.fields);
  elimination.factorise(m.a.get());
  core::Vector b = core::make_vector(MPI_COMM_WORLD, m.local, PETSC_DETERMINE), x = core::duplicate(b.get());
  check(VecSet(b.get(), 1));
  elimination.solve(b.get(), x.get());
  EXPECT_LT((whole * test::dense(x.get()) - VectorXd::Ones(m.n)).norm(), 1e-10);
}

// The hub goes to KLU on the rank that has most of it, to which the last one lends the border's row.
TEST(PortKrylov, SolvesWithInversesOfTheParts) {
  for (const bool border : {true, false}) {
    Machine m(border);
    solve::PortElimination elimination(m.fields, std::make_unique<OfOwnRows>(m));
    elimination.factorise(m.a.get());
    solve::PortKrylov krylov(*elimination.blocks().layout(), "similar_");
    core::Vector b = some(m), x = core::duplicate(b.get());
    EXPECT_TRUE(elimination.hub_alone());
    const int iterations = krylov.solve(elimination.blocks(), elimination, b.get(), x.get(), 1e-13);
    EXPECT_LT((test::dense(m.a.get()) * test::dense(x.get()) - test::dense(b.get())).norm(), 1e-11);
    if (core::size_of(MPI_COMM_WORLD) == 1) {
      EXPECT_LE(iterations, 2) << "the inverse is exact";
    }
  }
}

class SingularHub : public ::testing::TestWithParam<std::tuple<bool, bool>> {};

TEST_P(SingularHub, EndsInErrorsOfAllRanks) {
  const auto [border, by_inverse] = GetParam();
  Machine m(border);
  m.let_go(0);
  solve::PortElimination elimination(m.fields, by_inverse ? std::make_unique<OfOwnRows>(m) : nullptr);
  expect_agreed<core::NotConverged>([&] { elimination.factorise(m.a.get()); });
}

INSTANTIATE_TEST_SUITE_P(Kinds, SingularHub, ::testing::Combine(::testing::Bool(), ::testing::Bool()),
                         [](const auto& which) {
                           return std::string(std::get<0>(which.param) ? "border" : "alone") +
                                  (std::get<1>(which.param) ? "ByInverse" : "");
                         });

// A part that is singular, and a hub that the one rank which holds it does not solve.
TEST(PortKrylov, TellsAllRanksOfFailures) {
  Machine m(false);
  core::Vector b = some(m), x = core::duplicate(b.get());
  const auto fails = [&](std::unique_ptr<problem::PartInverse> inverse) {
    const test::WithOptions options(
        {{"-hub_ksp_type", "gmres"}, {"-hub_pc_type", "none"}, {"-hub_ksp_max_it", "1"}, {"-hub_ksp_rtol", "1e-12"}});
    solve::PortElimination elimination(m.fields, std::move(inverse));
    elimination.factorise(m.a.get());
    solve::PortKrylov krylov(*elimination.blocks().layout(), "similar_");
    expect_agreed<core::NotConverged>([&] { elimination.solve(b.get(), x.get()); });
    expect_agreed<core::DomainError>(
        [&] { (void)krylov.solve(elimination.blocks(), elimination, b.get(), x.get(), 1e-9); });
  };
  fails(nullptr);
  fails(std::make_unique<OfOwnRows>(m));
  for (PetscInt k = 11; k < 20; ++k)  // a row of the second part
    if (m.first <= 12 && 12 < m.first + m.local) check(MatSetValue(m.a.get(), 12, k, 0, INSERT_VALUES));
  m.assemble();
  solve::PortElimination singular(m.fields);
  expect_agreed<core::NotConverged>([&] { singular.factorise(m.a.get()); });
}
