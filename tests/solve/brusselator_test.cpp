// The Brusselator's cycle with collocation, shooting and Newton-Picard against an independent reference.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cycle_systems.hpp"
#include "reference/brusselator.hpp"
#include "support/at_points.hpp"
#include "support/brusselator.hpp"
#include "support/cycle_rows.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/solve/shooting/newton_picard.hpp"
#include "whirl/solve/shooting/shooting_problem.hpp"
#include "whirl/spectral/eigenvalues.hpp"

using namespace whirl;

namespace {

// A guess by integration on 8 cells towards the cycle, interpolated between the cells: 240 points over one period.
solve::Cycle guess(int cells) {
  static const solve::Cycle coarse = [] {
    test::Brusselator s(PETSC_COMM_SELF, 8);
    problem::ScaledPoint point(s, nullptr);
    solve::RungeKutta stepper(solve::dense_stages(point), solve::classical());
    const int per_period = 240;
    const double period = 3.432;
    Eigen::VectorXd x = s.disturbed();
    solve::Cycle c{solve::uniform_mesh(per_period), {}, period, 1};
    c.x.resize(x.size(), per_period);
    for (int k = 0; k < 20 * per_period; ++k) {
      stepper.step(0, 0, period / per_period, x, nullptr);
      c.x.col(k % per_period) = x;
    }
    return c;
  }();
  const Eigen::Index points = cells - 1;
  solve::Cycle fine{coarse.mesh, Eigen::MatrixXd(2 * points, coarse.x.cols()), coarse.period, 1};
  for (Eigen::Index i = 0; i < points; ++i) {
    const double z = 8.0 * static_cast<double>(i + 1) / cells;
    const auto left = std::min<Eigen::Index>(static_cast<Eigen::Index>(z), 7);
    for (Eigen::Index v = 0; v < 2; ++v) {
      const auto value = [&](Eigen::Index k) {
        if (k == 0 || k == 8) return Eigen::RowVectorXd(Eigen::RowVectorXd::Constant(240, v == 0 ? 2 : 5.45 / 2));
        return Eigen::RowVectorXd(coarse.x.row(2 * (k - 1) + v));
      };
      const double t = z - static_cast<double>(left);
      fine.x.row(2 * i + v) = (1 - t) * value(left) + t * value(left + 1);
    }
  }
  return fine;
}

solve::Scheme points() {
  return solve::make_scheme(1, solve::Points::radau);
}

// Each reference multiplier above 0.1 is among the values.
void expect_multipliers(const test::BrusselatorCycle& reference, const std::vector<std::complex<double>>& values,
                        double above, const char* what) {
  for (const auto& mu : reference.multipliers) {
    if (std::abs(mu) < above) continue;
    double nearest = 1;
    for (const auto& v : values) nearest = std::min(nearest, std::abs(v - mu));
    EXPECT_LE(nearest, 1e-6) << what << " " << reference.cells << " " << mu;
  }
}

solve::NewtonResult fixed(solve::ExtendedProblem& problem, Vec u) {
  core::Vector row = core::duplicate(u);
  solve::parameter_row(problem, row.get());
  solve::NewtonOptions o;
  o.tolerance = 1e-11;
  o.max_iterations = 25;
  const auto result = solve::newton(problem, u, row.get(), 1, o);
  EXPECT_TRUE(result.converged) << result.reason << " " << result.residual;
  problem.linearise(u, row.get());
  return result;
}

void newton_picard(const test::BrusselatorCycle& reference, const solve::Tableau& tableau, int intervals, int steps,
                   const char* what) {
  test::Brusselator s(MPI_COMM_WORLD, reference.cells);
  solve::NewtonPicardOptions o;
  o.autonomous = true;
  solve::NewtonPicardProblem problem(s, o, tableau, steps, solve::uniform_mesh(intervals));
  const auto start =
      test::rows_of(test::at_points(points(), guess(reference.cells), solve::uniform_mesh(intervals)), s);
  problem.set_phase_reference(start);
  core::Vector u = problem.scatter(start);
  const auto result = fixed(problem, u.get());
  const long to_converge = problem.products();
  const auto mu = problem.multipliers();
  EXPECT_NEAR(problem.gather(u.get()).period, reference.period, 1e-6) << what;
  expect_multipliers(reference, mu, o.radius, what);
  const double off = problem.gather(u.get()).period - reference.period;
  if (core::rank_of(MPI_COMM_WORLD) == 0)
    std::printf(
        "%s, %d cells: %d Newton and %d linear iterations, subspace %d, %ld products, %ld more for multipliers, "
        "period %.1e off\n",
        what, reference.cells, result.iterations, result.linear_iterations, static_cast<int>(problem.subspace()),
        to_converge, problem.products() - to_converge, off);
}

}  // namespace

TEST(Brusselator, DerivativesPassATaylorTest) {
  for (const auto which : {test::Brusselator::Parameter::length, test::Brusselator::Parameter::b}) {
    test::Brusselator s(MPI_COMM_WORLD, 8, which);
    core::Vector x = core::make_vector(MPI_COMM_WORLD, s.local_size(), PETSC_DETERMINE), d = core::duplicate(x.get());
    PetscInt begin = 0;
    core::check(VecGetOwnershipRange(x.get(), &begin, nullptr));
    {
      const core::WriteArray xa(x.get()), da(d.get());
      for (PetscInt k = 0; k < xa.size(); ++k) {
        xa[k] = s.disturbed()(begin + k);
        da[k] = std::cos(static_cast<double>(begin + k));
      }
    }
    const auto report = problem::taylor_test(s, 0, x.get(), d.get(), 1e-3);
    EXPECT_NEAR(report.state_order, 2, 0.1);
    EXPECT_NEAR(report.rate_order, 2, 0.1);
    EXPECT_NEAR(report.parameter_order, 2, 0.1);
  }
}

TEST(Brusselator, CollocationAndMultipleShooting) {
  for (const auto& reference : {test::brusselator_cycles[0], test::brusselator_cycles[1]}) {
    test::Brusselator s(PETSC_COMM_SELF, reference.cells);
    solve::CycleOptions o;
    o.degree = 4;
    o.autonomous = true;
    const solve::Cycle rough = guess(reference.cells);
    {
      solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(48));
      solve::Cycle start{problem.mesh(), Eigen::MatrixXd(s.size(), 48 * 4), rough.period, 1};
      for (int i = 0; i < 48; ++i)
        for (int l = 1; l <= 4; ++l)
          start.x.col(4 * i + l - 1) = rough.at(points(), (i + problem.scheme().node(l)) / 48.0);
      problem.set_phase_reference(start);
      core::Vector u = problem.scatter(start);
      fixed(problem, u.get());
      EXPECT_NEAR(problem.gather(u.get()).period, reference.period, 1e-6);
      expect_multipliers(reference, spectral::eigenvalues(problem.monodromy()), 0.04, "collocation");
    }
    for (const auto& [tableau, steps] : {std::pair(solve::radau_iia(3), 8), std::pair(solve::classical(), 40)}) {
      solve::ShootingProblem problem(MPI_COMM_WORLD, s, o, tableau, steps, solve::uniform_mesh(12));
      const auto start = test::at_points(points(), rough, problem.mesh());
      problem.set_phase_reference(start);
      core::Vector u = problem.scatter(start);
      fixed(problem, u.get());
      EXPECT_NEAR(problem.gather(u.get()).period, reference.period, 1e-6) << tableau.order;
      expect_multipliers(reference, spectral::eigenvalues(problem.monodromy()), 0.04, "shooting");
    }
  }
}

// Many small messages: the whole accuracy on one rank only.
TEST(Brusselator, ShootingBasedNewtonPicard) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP();
  newton_picard(test::brusselator_cycles[0], solve::sdirk(4), 1, 100, "shooting-based");
  newton_picard(test::brusselator_cycles[1], solve::sdirk(4), 1, 100, "shooting-based");
}

TEST(Brusselator, FiniteDifferenceBasedNewtonPicard) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP();
  newton_picard(test::brusselator_cycles[0], solve::classical(), 160, 1, "finite-difference-based");
  newton_picard(test::brusselator_cycles[2], solve::classical(), 160, 1, "finite-difference-based");
}

// The same coarse steps in space over all ranks and on each rank alone.
TEST(Brusselator, NewtonPicardOnAnyNumberOfRanks) {
  const auto run = [](MPI_Comm comm, const solve::Tableau& t, int intervals, int steps) {
    test::Brusselator s(comm, 8);
    solve::NewtonPicardOptions o;
    o.autonomous = true;
    solve::NewtonPicardProblem problem(s, o, t, steps, solve::uniform_mesh(intervals));
    const auto start = test::rows_of(test::at_points(points(), guess(8), solve::uniform_mesh(intervals)), s);
    problem.set_phase_reference(start);
    core::Vector u = problem.scatter(start);
    fixed(problem, u.get());
    return std::pair(test::whole_of(problem.gather(u.get()), s), problem.multipliers());
  };
  for (const auto& [t, intervals, steps] : {std::tuple(solve::sdirk(2), 1, 8), std::tuple(solve::heun(), 24, 1)}) {
    const auto whole = run(MPI_COMM_WORLD, t, intervals, steps), alone = run(PETSC_COMM_SELF, t, intervals, steps);
    EXPECT_NEAR(whole.first.period, alone.first.period, 1e-9);
    EXPECT_LE((whole.first.x - alone.first.x).cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_NEAR(std::abs(whole.second[1]), std::abs(alone.second[1]), 1e-8);
  }
}

// Five multipliers lie above the radius. The subspace of fewer preconditions as well: the cycle is the same.
TEST(Brusselator, NoMoreMultipliersAreSearchedForThanAskedFor) {
  const auto run = [](int most) {
    test::Brusselator s(MPI_COMM_WORLD, 8);
    solve::NewtonPicardOptions o;
    o.autonomous = true;
    o.radius = 0.1;
    o.multipliers = most;
    const auto mesh = solve::uniform_mesh(1);
    solve::NewtonPicardProblem problem(s, o, solve::sdirk(2), 40, mesh);
    const auto start = test::rows_of(test::at_points(points(), guess(8), mesh), s);
    problem.set_phase_reference(start);
    core::Vector u = problem.scatter(start);
    fixed(problem, u.get());
    const auto first = problem.multipliers();
    EXPECT_EQ(problem.multipliers().size(), first.size());
    return std::pair(problem.gather(u.get()).period, first);
  };
  const auto [period, all] = run(1 << 20);
  const auto [same_period, few] = run(2);
  const auto above = [](const auto& values) {
    return std::count_if(values.begin(), values.end(), [](auto mu) { return std::abs(mu) > 0.1; });
  };
  ASSERT_EQ(above(all), 5);
  ASSERT_GE(few.size(), 2U);
  EXPECT_LT(few.size(), 5U);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_LE(std::abs(few[k] - all[k]), 1e-7) << k;
  EXPECT_NEAR(same_period, period, 1e-9);
}
