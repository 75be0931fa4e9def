// All solvers of forced cycles on one oscillator with lags: the same cycle, multipliers and folds.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "branch_support.hpp"
#include "whirl/solve/shooting/newton_picard.hpp"
#include "whirl/solve/shooting/shooting_problem.hpp"

using namespace whirl;
using Eigen::VectorXd;
using solve::Event;
using test::Column;

namespace {

// Duffing's oscillator with lags in a row, the last of which acts back: few multipliers near one, the rest near zero.
template <int n>
struct LaggedDuffing {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T) const {
    Column<T> f(n);
    f(0) = xdot(0) - x(1);
    f(1) = xdot(1) + 0.1 * x(1) + x(0) + x(0) * x(0) * x(0) + 0.03 * x(n - 1) - 0.15 * std::cos(angle);
    for (int k = 2; k < n; ++k) f(k) = xdot(k) - (1 + 0.3 * k) * (x(k == 2 ? 0 : k - 1) - x(k));
    return f;
  }
};

constexpr double speed = 0.9;

solve::Scheme points() {
  return solve::make_scheme(1, solve::Points::radau);
}

struct Answer {
  VectorXd end;
  test::Complex largest;
};

solve::Cycle rest(const std::vector<double>& mesh, const solve::Scheme& scheme, double parameter, int n = 8) {
  return test::sampled(scheme, mesh, 1, parameter, [n](double) { return VectorXd(VectorXd::Zero(n)); });
}

// Largest multiplier with positive imaginary part.
test::Complex largest(const std::vector<test::Complex>& values) {
  return {values[0].real(), std::abs(values[0].imag())};
}

Answer collocation() {
  test::SmallSystem s(PETSC_COMM_SELF, 8, speed, 0, LaggedDuffing<8>{});
  solve::CycleOptions o;
  o.degree = 5;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(48));
  core::Vector u = problem.scatter(rest(problem.mesh(), problem.scheme(), speed)), row = core::duplicate(u.get());
  EXPECT_TRUE(test::solve_at(problem, u.get(), speed).converged);
  solve::parameter_row(problem, row.get());
  problem.linearise(u.get(), row.get());
  return {problem.gather(u.get()).x.rightCols(1), largest(spectral::eigenvalues(problem.monodromy()))};
}

Answer shooting(const solve::Tableau& t, int intervals, int steps) {
  test::SmallSystem s(PETSC_COMM_SELF, 8, speed, 0, LaggedDuffing<8>{});
  const MPI_Comm time = intervals == 1 ? PETSC_COMM_SELF : MPI_COMM_WORLD;
  solve::ShootingProblem problem(time, s, {}, t, steps, solve::uniform_mesh(intervals));
  core::Vector u = problem.scatter(rest(problem.mesh(), points(), speed)), row = core::duplicate(u.get());
  EXPECT_TRUE(test::solve_at(problem, u.get(), speed).converged);
  solve::parameter_row(problem, row.get());
  problem.linearise(u.get(), row.get());
  return {problem.gather(u.get()).x.rightCols(1), largest(spectral::eigenvalues(problem.monodromy()))};
}

Answer newton_picard(const solve::Tableau& t, int intervals, int steps) {
  test::SmallSystem s(PETSC_COMM_SELF, 8, speed, 0, LaggedDuffing<8>{});
  solve::NewtonPicardProblem problem(s, {}, t, steps, solve::uniform_mesh(intervals));
  core::Vector u = problem.scatter(rest(solve::uniform_mesh(intervals), points(), speed)),
               row = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  const auto r = solve::newton(problem, u.get(), row.get(), speed, test::sharp());
  EXPECT_TRUE(r.converged) << r.reason << " " << r.residual;
  problem.linearise(u.get(), row.get());
  const auto mu = problem.multipliers();
  EXPECT_LT(problem.subspace(), 8);
  return {problem.gather(u.get()).x.rightCols(1), largest(mu)};
}

// The branch over the folds by any solver.
template <class Problem, class Multipliers>
test::Recorded follow(Problem& problem, const solve::Cycle& guess, Multipliers multipliers) {
  test::Recorded r;
  auto callbacks = test::recording(problem, r);
  callbacks.cycles = true;
  callbacks.stability = [&](Vec) {
    return solve::make_stability(multipliers(), [](test::Complex z) { return std::abs(z) - 1; });
  };
  auto options = test::range(1.0, 2.2, 0.3);
  options.newton.tolerance = 1e-10;
  options.location_tolerance = 2e-5;
  r.end = solve::follow_branch(problem, problem.scatter(guess), options, callbacks);
  return r;
}

void expect_folds(const test::Recorded& r, const test::Recorded& reference, double tolerance, const char* what) {
  EXPECT_TRUE(r.end.completed) << what << ": " << r.end.reason;
  const auto a = r.of(Event::cyclic_fold), b = reference.of(Event::cyclic_fold);
  ASSERT_EQ(a.size(), 2U) << what;
  ASSERT_EQ(b.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(a[k].parameter, b[k].parameter, tolerance) << what;
}

}  // namespace

TEST(Solvers, AgreeOnCycleAndMultipliersWithTheirOrders) {
  const Answer exact = collocation();
  for (const auto& t : {solve::heun(), solve::third_order(), solve::classical(), solve::sdirk(2), solve::sdirk(4),
                        solve::radau_iia(2)}) {
    const int n = t.order < 3 ? 128 : 64;
    const Answer coarse = shooting(t, n, 1), fine = shooting(t, 2 * n, 1);
    const double order = std::log2((coarse.end - exact.end).norm() / (fine.end - exact.end).norm()),
                 multiplier_order =
                     std::log2(std::abs(coarse.largest - exact.largest) / std::abs(fine.largest - exact.largest));
    EXPECT_NEAR(order, t.order, 0.35) << t.stages();
    EXPECT_NEAR(multiplier_order, t.order, 0.35) << t.stages();
  }
}

// Newton-Picard solves the same equations as shooting with the same steps.
TEST(Solvers, NewtonPicardEqualsShooting) {
  for (const auto& [t, intervals, steps] :
       {std::tuple(solve::sdirk(4), 1, 24), std::tuple(solve::classical(), 40, 1), std::tuple(solve::sdirk(2), 4, 6)}) {
    const Answer a = newton_picard(t, intervals, steps), b = shooting(t, intervals, steps);
    EXPECT_LE((a.end - b.end).cwiseAbs().maxCoeff(), 1e-10) << t.order;
    EXPECT_LE(std::abs(a.largest - b.largest), 1e-8) << t.order;
  }
}

// On one rank: the parts that run in parallel are tested above, the continuation in branch_test.
TEST(Solvers, FoldsByEachOfThem) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP();
  test::SmallSystem s(PETSC_COMM_SELF, 4, 1, 0, LaggedDuffing<4>{});
  solve::CycleOptions o;
  o.degree = 4;
  solve::CycleProblem collocation(MPI_COMM_WORLD, s, o, solve::uniform_mesh(16));
  const auto reference = follow(collocation, rest(collocation.mesh(), collocation.scheme(), 1, 4),
                                [&] { return spectral::eigenvalues(collocation.monodromy()); });
  const auto shooting = [&](const solve::Tableau& t, int intervals, int steps, double tolerance, const char* what) {
    solve::ShootingProblem problem(intervals == 1 ? PETSC_COMM_SELF : MPI_COMM_WORLD, s, {}, t, steps,
                                   solve::uniform_mesh(intervals));
    expect_folds(follow(problem, rest(problem.mesh(), points(), 1, 4),
                        [&] { return spectral::eigenvalues(problem.monodromy()); }),
                 reference, tolerance, what);
  };
  shooting(solve::radau_iia(2), 1, 32, 5e-3, "single shooting");
  shooting(solve::radau_iia(3), 8, 3, 1e-4, "multiple shooting");
  shooting(solve::classical(), 48, 1, 1e-3, "finite differences");
  const auto picard = [&](const solve::Tableau& t, int intervals, int steps, double tolerance, const char* what) {
    solve::NewtonPicardProblem problem(s, {}, t, steps, solve::uniform_mesh(intervals));
    expect_folds(
        follow(problem, rest(solve::uniform_mesh(intervals), points(), 1, 4), [&] { return problem.multipliers(); }),
        reference, tolerance, what);
  };
  picard(solve::sdirk(2), 1, 32, 2e-2, "shooting-based Newton-Picard");
  picard(solve::classical(), 32, 1, 1e-3, "finite-difference-based Newton-Picard");
}
