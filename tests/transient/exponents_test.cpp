// Lyapunov exponents where they are known: eigenvalues, multipliers, normal forms, Lorenz.

#include <gtest/gtest.h>

#include "solve/cycle_systems.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/transient/analysis/exponents.hpp"
#include "whirl/transient/steps/integrator.hpp"

using namespace whirl;
using test::SmallSystem;
using test::two_pi;

namespace {

transient::Exponents exponents(SmallSystem& s, const problem::Drive& drive, const Eigen::VectorXd& x, int count,
                               double span, int discard, int spans, double tolerance) {
  transient::Integrator integrator(s, drive, s.vector(x).get(), {.tolerance = tolerance});
  transient::Tangents tangents(integrator.scaled(), count);
  integrator.carry(&tangents);
  transient::Exponents e(count);
  for (int i = 1; i <= discard + spans; ++i) {
    std::vector<double> growth(static_cast<std::size_t>(count), 0.0);
    // Often enough for the fastest decay.
    constexpr int parts = 16;
    for (int part = 1; part <= parts; ++part) {
      integrator.advance((i - 1 + static_cast<double>(part) / parts) * span);
      const std::vector<double> more = tangents.orthonormalise();
      for (std::size_t k = 0; k < more.size(); ++k) growth[k] += more[k];
    }
    if (i > discard) e.add(growth, span);
  }
  return e;
}

struct Lorenz {
  template <class T>
  test::Column<T> operator()(double, const test::Column<T>& x, const test::Column<T>& xdot, T p) const {
    test::Column<T> f(3);
    f << xdot(0) - 10.0 * (x(1) - x(0)), xdot(1) - (x(0) * (p - x(2)) - x(1)), xdot(2) - (x(0) * x(1) - 8.0 / 3 * x(2));
    return f;
  }
};

}  // namespace

// Of a linear system they are the real parts of its eigenvalues: -2 and twice -0.1.
TEST(Exponents, OfAnEquilibriumAreItsDecayRates) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the same on every rank";
  const auto linear = []<class T>(double, const test::Column<T>& x, const test::Column<T>& xdot, T) {
    test::Column<T> f(3);
    f << xdot(0) - x(1), 3.0 * xdot(1) + 0.6 * x(1) + 3.0 * x(0), xdot(2) + 2.0 * x(2) + 0.7 * x(0);
    return f;
  };
  SmallSystem s(PETSC_COMM_SELF, 3, 1, 1, linear);
  // Whole turns of the pair, so that its rotation in phase space leaves no remainder.
  const double span = two_pi / std::sqrt(1 - 0.01);
  const auto e = exponents(s, {1}, Eigen::Vector3d::Zero(), 3, span, 3, 16, 1e-9);
  EXPECT_NEAR(e.values()[0], -0.1, 1e-7);
  EXPECT_NEAR(e.values()[1], -0.1, 1e-7);
  EXPECT_NEAR(e.values()[2], -2, 1e-6);
  EXPECT_LT(e.uncertainties()[0], 1e-7);
}

// Of a cycle they are log|mu|/T, the multipliers by collocation.
TEST(Exponents, OfACycleAreItsMultipliers) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the same on every rank";
  SmallSystem s(PETSC_COMM_SELF, 2, 1.3, 0, test::ManufacturedDuffing());
  solve::CycleOptions o;
  o.degree = 4;
  solve::CycleProblem problem(PETSC_COMM_SELF, s, o, solve::uniform_mesh(40));
  const double period = two_pi / 1.3;
  core::Vector u =
      problem.scatter(test::sampled(problem.scheme(), problem.mesh(), period, 1.3, [](double angle) -> Eigen::VectorXd {
        return test::ManufacturedDuffing::exact(angle, 1.3);
      }));
  ASSERT_TRUE(test::solve_at(problem, u.get(), 1.3).converged);
  core::Vector row = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  problem.linearise(u.get(), row.get());
  const auto mu = spectral::eigenvalues(problem.monodromy());
  const auto e = exponents(s, {1.3}, test::ManufacturedDuffing::exact(0, 1.3), 2, period, 4, 32, 1e-8);
  // A complex pair turns the directions; their sum does not see that.
  EXPECT_NEAR(e.values()[0] + e.values()[1], std::log(std::abs(mu[0] * mu[1])) / period, 1e-7);
  EXPECT_NEAR(e.values()[0] + e.values()[1], -0.2, 1e-7);
  EXPECT_NEAR(e.values()[0], std::log(std::abs(mu[0])) / period, 2e-3);
  EXPECT_LT(std::abs(e.values()[0] - std::log(std::abs(mu[0])) / period), std::max(e.uncertainties()[0], 1e-7));
}

TEST(Exponents, OfASelfExcitedCycleHoldAZero) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the same on every rank";
  SmallSystem s(PETSC_COMM_SELF, 2, 0.25, 1, test::HopfNormalForm());
  const auto e =
      exponents(s, {1}, test::HopfNormalForm::exact(0, 0.25), 2, test::HopfNormalForm::period(0.25), 4, 16, 1e-8);
  EXPECT_NEAR(e.values()[0], 0, 1e-6);
  EXPECT_NEAR(e.values()[1], -0.5, 1e-6);
}

// Published: 0.9056, 0, -14.5723; their sum is the divergence -41/3 at any time (Sprott 2003, Chaos and Time-Series
// Analysis, table 5.1), dimension 2.062.
TEST(Exponents, OfTheLorenzAttractor) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the same on every rank";
  SmallSystem s(PETSC_COMM_SELF, 3, 28, 1, Lorenz());
  const auto e = exponents(s, {1}, Eigen::Vector3d(1, 2, 20), 3, 0.5, 20, 240, 1e-4);
  const auto l = e.values(), u = e.uncertainties();
  EXPECT_NEAR(l[0] + l[1] + l[2], -41.0 / 3, 2e-3);
  EXPECT_NEAR(l[0], 0.9056, u[0]);
  EXPECT_LT(u[0], 0.25);
  EXPECT_NEAR(l[1], 0, 0.03);
  EXPECT_NEAR(transient::kaplan_yorke_dimension(l), 2.062, 0.01);
}

TEST(Exponents, DimensionOfKaplanAndYorke) {
  EXPECT_DOUBLE_EQ(transient::kaplan_yorke_dimension({-1, -2}), 0);
  EXPECT_DOUBLE_EQ(transient::kaplan_yorke_dimension({0, -2}), 1);
  EXPECT_DOUBLE_EQ(transient::kaplan_yorke_dimension({1, 0, -2}), 2.5);
  EXPECT_TRUE(std::isnan(transient::kaplan_yorke_dimension({1, -0.5})));
}
