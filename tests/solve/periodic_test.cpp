// What branches ask of every solver of periodic solutions: multipliers, the motion of one of them, and the orbit
// between the unknowns, on a system that is known in closed form.

#include <gtest/gtest.h>

#include <memory>

#include "cycle_systems.hpp"
#include "support/cycle_rows.hpp"
#include "whirl/solve/shooting/newton_picard.hpp"
#include "whirl/solve/shooting/shooting_problem.hpp"

using namespace whirl;
using Eigen::Vector2d;
using test::Column;

namespace {

constexpr double speed = 2, parameter = -0.1, period = test::two_pi / speed;

Vector2d path(double angle) {
  return {std::sin(angle), std::cos(2 * angle)};
}

// x = path(angle) + R(angle/2) y with y' = diag(p, -1) y: the cycle x = path with multipliers -exp(p T) and -exp(-T).
struct HalfTurn {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const Vector2d r = path(angle);
    const double c = std::cos(angle / 2), s = std::sin(angle / 2);
    const T d0 = x(0) - r(0), d1 = x(1) - r(1), y0 = c * d0 + s * d1, y1 = c * d1 - s * d0;
    Column<T> f(2);
    f << xdot(0) - speed * std::cos(angle) + 0.5 * speed * d1 - (c * p * y0 + s * y1),
        xdot(1) + 2 * speed * std::sin(2 * angle) - 0.5 * speed * d0 - (s * p * y0 - c * y1);
    return f;
  }
};

void expect_answers(solve::PeriodicProblem& problem, const problem::System& system, const char* what) {
  const auto guess = test::sampled(problem.scheme(), problem.mesh(), period, parameter,
                                   [](double) { return Eigen::VectorXd(Eigen::VectorXd::Zero(2)); });
  core::Vector u = problem.scatter(test::rows_of(guess, system)), row = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  ASSERT_TRUE(solve::newton(problem, u.get(), row.get(), parameter, test::sharp()).converged) << what;
  problem.linearise(u.get(), row.get());

  const double mu = -std::exp(parameter * period);
  const auto values = problem.multipliers();
  ASSERT_FALSE(values.empty());
  EXPECT_NEAR(std::abs(values[0] - mu), 0, 1e-5) << what;

  const Eigen::MatrixXd motion = test::whole_of({problem.mesh(), problem.critical_motion(mu)}, system).x;
  ASSERT_EQ(motion.cols(), guess.x.cols()) << what;
  const double sign = motion(0, motion.cols() - 1) < 0 ? 1 : -1;  // v(1) = mu v(0)
  for (Eigen::Index i = 0; i < guess.intervals(); ++i)
    for (Eigen::Index l = 1; l <= problem.scheme().degree; ++l) {
      const auto k = static_cast<std::size_t>(i);
      const double s = problem.mesh()[k] + (problem.mesh()[k + 1] - problem.mesh()[k]) * problem.scheme().node(l);
      const Vector2d exact =
          std::exp(parameter * period * s) * Vector2d(std::cos(test::two_pi / 2 * s), std::sin(test::two_pi / 2 * s));
      EXPECT_LE((sign * motion.col(i * problem.scheme().degree + l - 1) - exact).norm(), 2e-5) << what << " " << s;
    }

  const solve::Cycle orbit = test::whole_of(problem.orbit(u.get()), system);
  EXPECT_NEAR(orbit.period, period, 1e-12);
  for (int k = 0; k < 50; ++k) {
    const double s = k / 50.0 + 0.003;
    EXPECT_LE((orbit.at(problem.orbit_scheme(), s) - path(test::two_pi * s)).norm(), 2e-5) << what << " " << s;
  }
}

}  // namespace

TEST(Periodic, EverySolverAnswersWhatBranchesAsk) {
  {
    test::SmallSystem s(PETSC_COMM_SELF, 2, parameter, speed, HalfTurn{});
    solve::CycleOptions o;
    o.degree = 4;
    solve::CycleProblem collocation(MPI_COMM_WORLD, s, o, test::uneven_mesh(3));
    expect_answers(collocation, s, "collocation");
    solve::ShootingProblem single(PETSC_COMM_SELF, s, {}, solve::radau_iia(3), 40, {0, 1}),
        multiple(MPI_COMM_WORLD, s, {}, solve::sdirk(4), 20, test::uneven_mesh(0)),
        differences(MPI_COMM_WORLD, s, {}, solve::classical(), 1, test::uneven_mesh(4));
    expect_answers(single, s, "single shooting");
    expect_answers(multiple, s, "multiple shooting");
    expect_answers(differences, s, "finite differences");
  }
  // Two states have room on two ranks.
  const MPI_Comm space = core::size_of(MPI_COMM_WORLD) <= 2 ? MPI_COMM_WORLD : PETSC_COMM_SELF;
  test::SmallSystem s(space, 2, parameter, speed, HalfTurn{});
  solve::NewtonPicardOptions o;
  solve::NewtonPicardProblem shooting(s, o, solve::sdirk(4), 48, {0, 1});
  o.constant_rates = true;
  solve::NewtonPicardProblem differences(s, o, solve::classical(), 1, test::uneven_mesh(4));
  expect_answers(shooting, s, "shooting-based Newton-Picard");
  expect_answers(differences, s, "finite-difference-based Newton-Picard");
}
