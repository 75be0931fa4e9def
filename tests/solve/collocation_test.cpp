// Observed orders of collocation on cycles with exact values, forced and autonomous.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "cycle_systems.hpp"
#include "whirl/spectral/eigenvalues.hpp"

using namespace whirl;
using solve::Points;

namespace {

// Largest error at the mesh points.
template <class Formula>
double mesh_error(int degree, Points points, int doublings) {
  const double p = 1.3;
  test::SmallSystem s(PETSC_COMM_SELF, 2, p, 0, Formula{});
  solve::CycleOptions o;
  o.degree = degree;
  o.points = points;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, test::uneven_mesh(doublings));
  const auto exact = [p](double angle) { return Eigen::VectorXd(Formula::exact(angle, p)); };
  core::Vector u = problem.scatter(test::sampled(problem.scheme(), problem.mesh(), test::two_pi / p, p, exact));
  const auto result = test::solve_at(problem, u.get(), p);
  EXPECT_TRUE(result.converged) << result.reason << " " << result.residual;
  const solve::Cycle c = problem.gather(u.get());
  EXPECT_NEAR(c.period, test::two_pi / p, 1e-14);
  double error = 0;
  for (Eigen::Index i = 0; i < c.intervals(); ++i) {
    const Eigen::VectorXd d =
        c.x.col((i + 1) * degree - 1) - exact(test::two_pi * c.mesh[static_cast<std::size_t>(i) + 1]);
    error = std::max(error, d.cwiseAbs().maxCoeff());
  }
  return error;
}

template <class Formula>
void orders(std::array<int, 4> doublings) {
  for (const Points points : {Points::radau, Points::gauss})
    for (int m = 1; m <= 4; ++m) {
      const int theory = points == Points::radau ? 2 * m - 1 : 2 * m;
      // Coarser meshes for higher orders, so that the error stays above rounding.
      const int k = doublings[static_cast<std::size_t>(m) - 1];
      const double coarse = mesh_error<Formula>(m, points, k), fine = mesh_error<Formula>(m, points, k + 1);
      const double order = std::log2(coarse / fine);
      EXPECT_GE(order, theory - 0.1) << "degree " << m << (points == Points::radau ? " Radau " : " Gauss ") << coarse
                                     << " " << fine;
    }
}

}  // namespace

TEST(Collocation, OrdersOnALinearOscillator) {
  orders<test::LinearOscillator>({6, 5, 3, 2});
}
TEST(Collocation, OrdersOnAManufacturedDuffingOscillator) {
  orders<test::ManufacturedDuffing>({8, 5, 4, 3});
}

// T of van der Pol's oscillator at mu = 1: 6.663286859323 (an independent integration of tolerance 1e-13
// gives 6.66328686).
TEST(Collocation, PeriodOfVanDerPol) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 1, 1, test::VanDerPol{});
  solve::CycleOptions o;
  o.degree = 4;
  o.autonomous = true;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(64));
  const auto guess = test::sampled(problem.scheme(), problem.mesh(), 6.5, 1, [](double a) {
    return Eigen::VectorXd(Eigen::Vector2d(2 * std::cos(a), -2 * std::sin(a)));
  });
  problem.set_phase_reference(guess);
  core::Vector u = problem.scatter(guess);
  EXPECT_TRUE(test::solve_at(problem, u.get(), 1).converged);
  EXPECT_NEAR(problem.gather(u.get()).period, 6.663286859323, 1e-9);
}

TEST(Collocation, HopfNormalFormHasItsPeriodRadiusAndMultipliers) {
  const double p = 0.36;
  test::SmallSystem s(PETSC_COMM_SELF, 2, p, 1, test::HopfNormalForm{});
  solve::CycleOptions o;
  o.degree = 4;
  o.autonomous = true;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, test::uneven_mesh(3));
  const auto guess = test::sampled(problem.scheme(), problem.mesh(), 7, p,
                                   [](double a) { return Eigen::VectorXd(test::HopfNormalForm::exact(a + 0.3, 0.5)); });
  problem.set_phase_reference(guess);
  core::Vector u = problem.scatter(guess), row = core::duplicate(u.get());
  ASSERT_TRUE(test::solve_at(problem, u.get(), p).converged);
  const solve::Cycle c = problem.gather(u.get());
  const double period = test::HopfNormalForm::period(p);
  EXPECT_NEAR(c.period, period, 1e-8);
  EXPECT_NEAR(c.x.col(3).norm(), std::sqrt(p), 1e-8);
  // In phase with the reference.
  EXPECT_NEAR(std::atan2(c.x(1, c.x.cols() - 1), c.x(0, c.x.cols() - 1)), 0.3, 1e-8);
  solve::parameter_row(problem, row.get());
  problem.linearise(u.get(), row.get());
  const auto mu = spectral::eigenvalues(problem.monodromy());
  EXPECT_NEAR(std::abs(mu[0] - 1.0), 0, 1e-8);
  EXPECT_NEAR(std::abs(mu[1] - std::exp(-2 * p * period)), 0, 1e-8);
}
