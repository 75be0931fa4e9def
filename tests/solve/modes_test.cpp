// Cycles solved by time modes: the same linear algebra as by dense transitions, on any mesh and any number of ranks.

#include <gtest/gtest.h>

#include "cycle_systems.hpp"

using namespace whirl;
using Joining = solve::CycleOptions::Joining;
using test::Column;

namespace {

constexpr int masses = 6;

struct Load {
  bool forced;
  template <class T>
  Column<T> operator()(double angle, T p) const {
    Column<T> u = Column<T>::Zero(2 * masses + 1);
    u(1) = forced ? 0.4 * p * p * std::cos(angle) : T(0.0);
    u(5) = 0.3 + (forced ? 0.2 * std::sin(2 * angle) : 0.0);
    return u;
  }
};
struct Forces {
  template <class T>
  Column<T> operator()(const Column<T>& w, T p) const {
    Column<T> f(2);
    f << p * (1.0 - w(0) * w(0)) * w(1), -0.4 * w(2) * w(2) * w(2) + 0.1 * sin(w(0)) * p;
    return f;
  }
};

// A free chain of damped masses with gyroscopic neighbours and a first-order lag at its end; states (q1, v1, q2, ...).
// Without its forces the chain drifts: L0 is singular.
std::unique_ptr<test::StructuredSystem> chain(bool forced) {
  constexpr int n = 2 * masses + 1;
  test::Blocks blocks;
  blocks.l1 = blocks.l0 = blocks.l0p = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < masses; ++i) {
    blocks.l1(2 * i, 2 * i) = 1 + 0.1 * i;
    blocks.l0(2 * i, 2 * i + 1) = -(1 + 0.1 * i);
    blocks.kinematic.push_back({2 * i, 2 * i, 2 * i + 1});
    blocks.l1(2 * i + 1, 2 * i + 1) = 1 + 0.2 * i;
    for (const int k : {i - 1, i + 1}) {
      if (k < 0 || k >= masses) continue;
      blocks.l0(2 * i + 1, 2 * i) += 1.5;
      blocks.l0(2 * i + 1, 2 * k) -= 1.5;
      blocks.l0(2 * i + 1, 2 * i + 1) += 0.1;
      blocks.l0(2 * i + 1, 2 * k + 1) -= 0.1;
      blocks.l0p(2 * i + 1, 2 * k + 1) += 0.05 * (k - i);
      blocks.l1(2 * i + 1, 2 * k + 1) += 0.05;
    }
  }
  blocks.l1(n - 1, n - 1) = 1;
  blocks.l0(n - 1, n - 1) = 3;
  blocks.l0(n - 1, n - 3) = -0.5;
  blocks.b = Eigen::MatrixXd::Zero(n, 2);
  blocks.b(1, 0) = blocks.b(7, 1) = 1;
  blocks.b(9, 1) = -0.5;
  blocks.c = Eigen::MatrixXd::Zero(3, n);
  blocks.c(0, 0) = blocks.c(1, 1) = 1;
  blocks.c(2, 6) = 1;
  blocks.c(2, n - 1) = 0.5;
  auto s = std::make_unique<test::StructuredSystem>(0.8, forced ? 0 : 1.1, blocks, Load{forced}, Forces{});
  Eigen::VectorXd scale = Eigen::VectorXd::LinSpaced(n, 0.5, 2), rows = Eigen::VectorXd::LinSpaced(n, 3, 1);
  s->set_scales(scale, rows);
  return s;
}

struct Linearised {
  std::unique_ptr<test::StructuredSystem> system;
  std::unique_ptr<solve::CycleProblem> problem;
};

// A cycle that solves nothing: only its linearisation is looked at.
Linearised linearised(bool forced, Joining joining, int degree, const std::vector<double>& mesh, bool rows) {
  Linearised out{chain(forced), nullptr};
  solve::CycleOptions o;
  o.degree = degree;
  o.autonomous = !forced;
  o.joining = joining;
  o.parameter_scale = 2;
  out.problem = std::make_unique<solve::CycleProblem>(MPI_COMM_WORLD, *out.system, o, mesh);
  const auto cycle = test::sampled(out.problem->scheme(), mesh, 5.5, 0.8, [](double angle) {
    Eigen::VectorXd x(2 * masses + 1);
    for (Eigen::Index k = 0; k < x.size(); ++k) x(k) = 1.2 * std::sin(angle + 0.5 * static_cast<double>(k)) + 0.1;
    return x;
  });
  if (!forced) out.problem->set_phase_reference(cycle);
  core::Vector u = out.problem->scatter(cycle), row = core::duplicate(u.get());
  if (rows)
    core::check(VecPointwiseMult(row.get(), u.get(), out.problem->weights()));
  else
    solve::parameter_row(*out.problem, row.get());
  out.problem->linearise(u.get(), row.get());
  return out;
}

core::Vector generic(const solve::CycleProblem& p, double phase) {
  core::Vector v = p.make_unknown();
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(v.get(), &begin, nullptr));
  const core::WriteArray a(v.get());
  for (PetscInt k = 0; k < a.size(); ++k) a[k] = std::sin(phase + 0.37 * static_cast<double>(begin + k));
  return v;
}

double apart(Vec a, Vec b) {
  core::Vector d = core::duplicate(a);
  core::check(VecCopy(a, d.get()));
  core::check(VecAXPY(d.get(), -1, b));
  double distance = 0, size = 0;
  core::check(VecNorm(d.get(), NORM_INFINITY, &distance));
  core::check(VecNorm(b, NORM_INFINITY, &size));
  return distance / size;
}

double dot(Vec a, Vec b) {
  double value = 0;
  core::check(VecDot(a, b, &value));
  return value;
}

void compare(bool forced, int degree, const std::vector<double>& mesh, bool rows) {
  SCOPED_TRACE(testing::Message() << "forced " << forced << " degree " << degree << " intervals " << mesh.size() - 1
                                  << " rows " << rows);
  const Linearised dense = linearised(forced, Joining::dense, degree, mesh, rows),
                   modes = linearised(forced, Joining::modes, degree, mesh, rows);
  solve::CycleProblem &a = *dense.problem, &b = *modes.problem;
  core::Vector rhs = generic(a, 0.3), other = generic(a, 1.9), x = core::duplicate(rhs.get()),
               y = core::duplicate(rhs.get());
  a.multiply(rhs.get(), x.get());
  b.multiply(rhs.get(), y.get());
  EXPECT_LE(apart(y.get(), x.get()), 1e-12);
  a.solve(rhs.get(), x.get());
  b.solve(rhs.get(), y.get());
  EXPECT_LE(apart(y.get(), x.get()), 1e-6);
  b.multiply(y.get(), x.get());
  EXPECT_LE(apart(x.get(), rhs.get()), 1e-7);
  b.solve_transposed(other.get(), x.get());
  EXPECT_NEAR(dot(x.get(), rhs.get()) / dot(other.get(), y.get()), 1, 1e-6);
  const auto all = a.multipliers(), few = b.multipliers();
  ASSERT_GE(few.size(), 2U);
  for (std::size_t k = 0; k < few.size() && std::abs(few[k]) > 0.3; ++k)
    EXPECT_NEAR(std::abs(few[k]), std::abs(all[k]), 1e-7) << k;
  Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(2 * masses + 1, -1, 2);
  EXPECT_LE((a.propagate(v) - b.propagate(v)).cwiseAbs().maxCoeff(), 1e-8 * a.propagate(v).cwiseAbs().maxCoeff());
  const Eigen::MatrixXd w = v, there = a.composition().times_transposed(w), here = b.composition().times_transposed(w);
  EXPECT_LE((here - there).cwiseAbs().maxCoeff(), 1e-8 * there.cwiseAbs().maxCoeff());
}

}  // namespace

TEST(TimeModes, AreTheSameEquations) {
  for (const bool forced : {true, false})
    for (const bool rows : {false, true}) {
      compare(forced, 2, solve::uniform_mesh(24), rows);
      compare(forced, 3, test::uneven_mesh(2), rows);
      compare(forced, 1, test::uneven_mesh(3), rows);
    }
  compare(true, 4, solve::uniform_mesh(7), true);
}

// The forces' small system as a dense matrix, where GMRES does not arrive.
TEST(TimeModes, SmallSystemCanBeDense) {
  core::check(PetscOptionsSetValue(nullptr, "-forces_ksp_max_it", "2"));
  compare(true, 2, solve::uniform_mesh(24), true);
  compare(false, 3, test::uneven_mesh(1), true);
  core::check(PetscOptionsClearValue(nullptr, "-forces_ksp_max_it"));
}

TEST(TimeModes, WantRadauPoints) {
  const auto s = chain(true);
  solve::CycleOptions o;
  o.joining = Joining::modes;
  o.points = solve::Points::gauss;
  EXPECT_ANY_THROW(solve::CycleProblem(MPI_COMM_WORLD, *s, o, solve::uniform_mesh(8)));
}
