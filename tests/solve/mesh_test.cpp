// Cycles as data: round trips, interpolation, error estimates and adapted meshes.

#include <gtest/gtest.h>

#include <algorithm>

#include "cycle_systems.hpp"

using namespace whirl;
using Eigen::VectorXd;

namespace {

// A cycle with a front of width `width` at s = 0.5.
VectorXd front(double angle, double width) {
  const double s = angle / test::two_pi;
  VectorXd x(2);
  x << std::cos(angle) + std::tanh((s - 0.5) / width) * std::sin(angle / 2) * std::sin(angle / 2), std::sin(angle);
  return x;
}

}  // namespace

TEST(Cycle, ScatterAndGatherAreARoundTrip) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 1.3, 0, test::LinearOscillator{});
  s.set_scales(Eigen::Vector2d(1e-6, 40), Eigen::Vector2d(1, 2));
  for (const bool autonomous : {false, true}) {
    solve::CycleOptions o;
    o.degree = 3;
    o.autonomous = autonomous;
    o.parameter_scale = 0.1;
    solve::CycleProblem problem(MPI_COMM_WORLD, s, o, test::uneven_mesh(1));
    auto c = test::sampled(problem.scheme(), problem.mesh(), autonomous ? 3.7 : test::two_pi / 1.3, 1.3,
                           [](double a) { return front(a, 0.1); });
    if (autonomous) problem.set_phase_reference(c);
    const core::Vector u = problem.scatter(c);
    const solve::Cycle back = problem.gather(u.get());
    EXPECT_LE((back.x - c.x).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_NEAR(back.period, c.period, 1e-14);
    EXPECT_NEAR(back.parameter, 1.3, 1e-15);
    EXPECT_EQ(back.mesh, c.mesh);
  }
}

TEST(Cycle, AnAutonomousProblemWantsItsPhaseReferenceFirst) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 1, 1, test::VanDerPol{});
  solve::CycleOptions o;
  o.autonomous = true;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(6));
  const auto c = test::sampled(problem.scheme(), problem.mesh(), 6, 1, [](double a) { return front(a, 1); });
  EXPECT_THROW((void)problem.scatter(c), core::Bug);
}

TEST(Cycle, InterpolationIsOfOrderDegreePlusOne) {
  for (const auto points : {solve::Points::radau, solve::Points::gauss})
    for (int m = 1; m <= 4; ++m) {
      const solve::Scheme scheme = solve::make_scheme(m, points);
      double error[2] = {0, 0};
      for (int k = 0; k < 2; ++k) {
        const auto c = test::sampled(scheme, test::uneven_mesh(3 + k), 1, 1, [](double a) { return front(a, 0.4); });
        for (int q = 0; q <= 1000; ++q)
          error[k] = std::max(error[k], (c.at(scheme, q / 1000.0) - front(test::two_pi * q / 1000.0, 0.4)).norm());
        // Another mesh that contains this one carries the same polynomials.
        const solve::Cycle finer = c.on(scheme, solve::doubled(c.mesh));
        EXPECT_LE((finer.at(scheme, 0.3371) - c.at(scheme, 0.3371)).norm(), 1e-13);
      }
      EXPECT_GE(std::log2(error[0] / error[1]), m + 1 - 0.15) << m;
    }
}

TEST(Mesh, ErrorEstimateIsOfOrderDegreePlusOneAndNearTheError) {
  for (int m = 1; m <= 4; ++m) {
    const solve::Scheme scheme = solve::make_scheme(m, solve::Points::radau);
    double estimate[2];
    for (int k = 0; k < 2; ++k) {
      const auto c = test::sampled(scheme, solve::uniform_mesh(32 << k), 1, 1,
                                   [](double a) { return VectorXd(Eigen::Vector2d(std::cos(a), std::sin(a))); });
      const auto e = solve::interval_errors(scheme, c, Eigen::Vector2d(1, 1));
      EXPECT_EQ(e.size(), static_cast<std::size_t>(32 << k));
      estimate[k] = *std::max_element(e.begin(), e.end());
      double error = 0;
      for (int q = 0; q <= 2000; ++q) {
        const double a = test::two_pi * q / 2000.0;
        error = std::max(error,
                         (c.at(scheme, q / 2000.0) - Eigen::Vector2d(std::cos(a), std::sin(a))).cwiseAbs().maxCoeff());
      }
      EXPECT_GE(estimate[k], 0.5 * error) << m;
      EXPECT_LE(estimate[k], 20 * error) << m;
    }
    EXPECT_NEAR(std::log2(estimate[0] / estimate[1]), m + 1, 0.1);
  }
}

TEST(Mesh, ARestingStateHasNoError) {
  const solve::Scheme scheme = solve::make_scheme(4, solve::Points::radau);
  auto c =
      test::sampled(scheme, solve::uniform_mesh(20), 1, 1, [](double) { return VectorXd(Eigen::Vector2d(1, 0.3)); });
  c.x += 1e-14 * Eigen::MatrixXd::Random(c.x.rows(), c.x.cols());
  EXPECT_EQ(solve::adapted_mesh(scheme, c, Eigen::Vector2d(1, 1), 1e-3, 20, 400).size(), 21U);
}

TEST(Mesh, SplitsAtAFrontAndMergesBack) {
  const solve::Scheme scheme = solve::make_scheme(3, solve::Points::radau);
  const Eigen::Vector2d scale(1, 1);
  const int base = 10;
  const double tolerance = 1e-4;
  std::vector<double> mesh = solve::uniform_mesh(base);
  double first = 0, last = 0;
  for (int pass = 0; pass < 6; ++pass) {
    const auto c = test::sampled(scheme, mesh, 1, 1, [](double a) { return front(a, 0.02); });
    const auto e = solve::interval_errors(scheme, c, scale);
    last = *std::max_element(e.begin(), e.end());
    if (pass == 0) first = last;
    mesh = solve::adapted_mesh(scheme, c, scale, tolerance, base, 400);
    ASSERT_EQ(mesh.front(), 0);
    ASSERT_EQ(mesh.back(), 1);
    for (std::size_t i = 0; i + 1 < mesh.size(); ++i) {
      const double level = std::log2(1.0 / base / (mesh[i + 1] - mesh[i]));
      EXPECT_NEAR(level, std::round(level), 1e-9);
      EXPECT_GE(level, -1e-9);
    }
  }
  EXPECT_LE(last, tolerance);
  EXPECT_GE(first, 50 * tolerance);
  const auto length_at = [&mesh](double s) {
    const auto it = std::upper_bound(mesh.begin(), mesh.end(), s);
    return *it - *(it - 1);
  };
  EXPECT_LE(length_at(0.501), length_at(0.05) / 4);

  // The front gone, the mesh returns to its base.
  for (int pass = 0; pass < 6; ++pass) {
    const auto c = test::sampled(scheme, mesh, 1, 1, [](double a) { return front(a, 1); });
    mesh = solve::adapted_mesh(scheme, c, scale, 0.1, base, 400);
  }
  EXPECT_EQ(mesh.size(), static_cast<std::size_t>(base) + 1);
}

TEST(Mesh, AllowsALargerErrorWhereTooManyIntervalsWouldBeNeeded) {
  const solve::Scheme scheme = solve::make_scheme(2, solve::Points::radau);
  const auto c = test::sampled(scheme, solve::uniform_mesh(10), 1, 1, [](double a) { return front(a, 0.02); });
  const auto mesh = solve::adapted_mesh(scheme, c, Eigen::Vector2d(1, 1), 1e-9, 10, 30);
  EXPECT_GT(mesh.size(), c.mesh.size());
  EXPECT_LE(mesh.size(), 31U);
}

// A relaxation oscillation: the mesh of a problem follows it, with fewer intervals than a uniform one of its accuracy,
// and goes back to its base when the oscillation is smooth again.
TEST(Mesh, FollowsARelaxationOscillation) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 1, 1, test::VanDerPol{});
  solve::CycleOptions o;
  o.degree = 4;
  o.autonomous = true;
  o.mesh_tolerance = 1e-4;
  o.base_intervals = 16;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(16));
  const auto guess = test::sampled(problem.scheme(), problem.mesh(), 6.5, 1, [](double a) {
    return VectorXd(Eigen::Vector2d(2 * std::cos(a), -2 * std::sin(a)));
  });
  problem.set_phase_reference(guess);
  core::Vector u = problem.scatter(guess), tangent = core::duplicate(u.get());
  core::check(VecSet(tangent.get(), 0.0));
  const auto walk = [&](double p) {
    ASSERT_TRUE(test::solve_at(problem, u.get(), p).converged) << p;
    if (problem.adapt(u, tangent)) {
      ASSERT_TRUE(test::solve_at(problem, u.get(), p).converged) << p;
    }
  };
  for (const double p : {1.0, 1.4, 1.8, 2.3, 2.8, 3.4, 4.0, 4.6, 5.0, 5.0, 5.0}) walk(p);
  const solve::Cycle stiff = problem.gather(u.get());
  // T at mu = 5 by an independent integration (Dormand and Prince, order 8, tolerance 1e-13): 11.61223067.
  EXPECT_NEAR(stiff.period, 11.61223067, 2e-4);
  double shortest = 1, longest = 0;
  for (std::size_t i = 0; i + 1 < stiff.mesh.size(); ++i) {
    shortest = std::min(shortest, stiff.mesh[i + 1] - stiff.mesh[i]);
    longest = std::max(longest, stiff.mesh[i + 1] - stiff.mesh[i]);
  }
  EXPECT_GE(longest, 3.9 * shortest);
  EXPECT_LE(stiff.intervals(), 120);
  for (const double p : {4.4, 3.8, 3.2, 2.6, 2.1, 1.6, 1.2, 0.8, 0.5, 0.3, 0.1, 0.1, 0.1}) walk(p);
  EXPECT_EQ(problem.mesh().size(), 17U) << stiff.intervals();
}
