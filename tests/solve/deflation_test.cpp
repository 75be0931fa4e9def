// Coexisting solutions: equilibria in closed form, and the three cycles of a bent resonance.

#include "whirl/solve/branch/deflation.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "branch_support.hpp"

using namespace whirl;
using test::Column;

namespace {

// x (x^2 - 1) = 0 and y (y^2 - 4) = 0 with a weak coupling through a follower: nine equilibria.
struct Nine {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(3);
    f << xdot(0) + x(0) * (x(0) * x(0) - p), xdot(1) + x(1) * (x(1) * x(1) - 4.0 * p), xdot(2) + x(2) - x(0) * x(1);
    return f;
  }
};

core::Vector at(const solve::EquilibriumProblem& problem, const test::SmallSystem& s, const Eigen::VectorXd& x) {
  core::Vector u = problem.make_unknown();
  const core::Vector state = s.vector(x);
  problem.from_state(state.get(), 1, u.get());
  return u;
}

// x'' + 0.1 x' + x + x^3 = 0.3 cos(angle): amplitudes of the one-term balance at a speed in the bend are three.
struct Duffing {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T) const {
    Column<T> f(2);
    f << xdot(0) - x(1), xdot(1) + 0.1 * x(1) + x(0) + x(0) * x(0) * x(0) - 0.3 * std::cos(angle);
    return f;
  }
};

}  // namespace

// Exactly on a known solution the deflated equations are not defined, on all ranks at once: that is no solution, and no
// reason to end the program.
TEST(Deflation, AGuessThatIsKnownAlreadyLeadsNowhere) {
  test::SmallSystem s(MPI_COMM_WORLD, 3, 1, 1, Nine{});
  solve::EquilibriumProblem problem(s, 1, 1);
  std::vector<core::Vector> known;
  known.push_back(at(problem, s, Eigen::Vector3d::Zero()));
  solve::DeflationOptions options;
  options.attempts = 2;
  const auto guess = [&](int) { return at(problem, s, Eigen::Vector3d::Zero()); };
  EXPECT_TRUE(solve::deflate(problem, 1, known, guess, options).empty());
}

TEST(Deflation, FindsAllNineEquilibriaFromOneGuess) {
  test::SmallSystem s(MPI_COMM_WORLD, 3, 1, 1, Nine{});
  solve::EquilibriumProblem problem(s, 1, 1);
  std::vector<core::Vector> known;
  known.push_back(at(problem, s, Eigen::Vector3d::Zero()));
  solve::DeflationOptions options;
  options.solutions = 20;  // more than there are
  options.attempts = 30;
  options.newton.max_iterations = 200;
  const auto guess = [&](int k) {
    const double angle = 2.4 * k, out = 0.1 * (k + 1);
    return at(problem, s, Eigen::Vector3d(out * std::cos(angle), out * std::sin(angle), 0.1));
  };
  const auto found = solve::deflate(problem, 1, known, guess, options);
  EXPECT_EQ(found.size(), 8U);
  std::vector<std::pair<double, double>> places{{0, 0}};
  for (const auto& u : found) {
    core::Vector x = s.vector(Eigen::Vector3d::Zero());
    problem.to_state(u.get(), x.get());
    const Eigen::VectorXd v = s.gather(x.get());
    EXPECT_NEAR(v(0), std::round(v(0)), 1e-9);
    EXPECT_NEAR(v(1) / 2, std::round(v(1) / 2), 1e-9);
    EXPECT_NEAR(v(2), v(0) * v(1), 1e-9);
    places.emplace_back(std::round(v(0)), std::round(v(1)));
  }
  std::sort(places.begin(), places.end());
  EXPECT_EQ(std::unique(places.begin(), places.end()), places.end());
}

// Newton's step on the deflated equations at a constant parameter is the ordinary one times 1/(1 - grad(m).s/m), and
// the matrix is the derivative of the residual.
TEST(Deflation, MatrixIsTheDerivativeOfTheDeflatedResidual) {
  test::SmallSystem s(MPI_COMM_WORLD, 3, 1, 1, Nine{});
  solve::EquilibriumProblem problem(s, 1, 1);
  solve::DeflatedProblem deflated(problem, 2, 1);
  deflated.take_out(at(problem, s, Eigen::Vector3d(1, 2, 2)).get());
  deflated.take_out(at(problem, s, Eigen::Vector3d(0, 0, 0)).get());
  const core::Vector u = at(problem, s, Eigen::Vector3d(0.4, 0.7, -0.3)),
                     v = at(problem, s, Eigen::Vector3d(0.3, -0.5, 0.2));
  core::Vector row = core::duplicate(u.get()), y = core::duplicate(u.get()), back = core::duplicate(u.get()),
               moved = core::duplicate(u.get()), difference = core::duplicate(u.get()), r = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  solve::set_last_entry(MPI_COMM_WORLD, v.get(), 0.2);
  deflated.linearise(u.get(), row.get());
  deflated.multiply(v.get(), y.get());
  deflated.solve(y.get(), back.get());
  core::check(VecAXPY(back.get(), -1, v.get()));
  double norm = 0, size = 0;
  core::check(VecNorm(back.get(), NORM_2, &norm));
  EXPECT_LE(norm, 1e-12);
  const double h = 1e-6;
  core::check(VecSet(difference.get(), 0));
  for (const double sign : {1.0, -1.0}) {
    core::check(VecCopy(u.get(), moved.get()));
    core::check(VecAXPY(moved.get(), sign * h, v.get()));
    core::check(VecSet(r.get(), 0));
    deflated.residual(moved.get(), r.get());
    core::check(VecAXPY(difference.get(), sign / (2 * h), r.get()));
  }
  core::check(VecNorm(y.get(), NORM_2, &size));
  core::check(VecAXPY(difference.get(), -1, y.get()));
  solve::set_last_entry(MPI_COMM_WORLD, difference.get(), 0);
  core::check(VecNorm(difference.get(), NORM_2, &norm));
  EXPECT_LE(norm, 1e-8 * size);
}

// Between the folds of the bent resonance three cycles coexist; a branch passes all of them.
TEST(Deflation, FindsTheCyclesBetweenTwoFolds) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 1.6, 0, Duffing{});
  solve::CycleOptions options;
  options.degree = 4;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, options, solve::uniform_mesh(20));
  const auto cycle = [&](double amplitude, double phase) {
    return test::sampled(problem.scheme(), problem.mesh(), 1, 1.6, [=](double angle) {
      return Eigen::VectorXd(
          Eigen::Vector2d(amplitude * std::cos(angle - phase), -1.6 * amplitude * std::sin(angle - phase)));
    });
  };
  core::Vector u = problem.scatter(cycle(0.2, test::two_pi / 2)), row = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  solve::NewtonOptions newton;
  newton.max_iterations = 60;
  ASSERT_TRUE(solve::newton(problem, u.get(), row.get(), 1.6, newton).converged);
  std::vector<core::Vector> known;
  known.push_back(std::move(u));
  solve::DeflationOptions o;
  o.solutions = 6;
  o.attempts = 8;
  o.newton = newton;
  const auto found = solve::deflate(
      problem, 1, known, [&](int k) { return problem.scatter(cycle(0.3 + 0.3 * k, 0.7 * k)); }, o);
  ASSERT_EQ(found.size(), 2U);
  std::vector<double> amplitudes;
  for (const auto& v : found) {
    const auto c = problem.gather(v.get());
    amplitudes.push_back(c.x.row(0).cwiseAbs().maxCoeff());
  }
  amplitudes.push_back(problem.gather(known[0].get()).x.row(0).cwiseAbs().maxCoeff());
  std::sort(amplitudes.begin(), amplitudes.end());
  // The same three from a branch through both folds.
  test::Recorded r;
  auto callbacks = test::recording(problem, r);
  callbacks.cycles = true;
  std::vector<double> passed;
  double before = 0, last = 0;
  callbacks.on_point = [&](const solve::BranchPoint& p, Vec v) {
    const double now = problem.gather(v).x.row(0).cwiseAbs().maxCoeff();
    if (p.index > 0 && (before - 1.6) * (p.parameter - 1.6) <= 0)
      passed.push_back(last + (now - last) * (1.6 - before) / (p.parameter - before));
    before = p.parameter;
    last = now;
  };
  auto range = test::range(0.5, 3, 0.02);
  range.max_points = 2000;
  const auto start = test::sampled(problem.scheme(), problem.mesh(), 1, 0.5, [](double angle) {
    return Eigen::VectorXd(Eigen::Vector2d(0.3 * std::cos(angle), -0.15 * std::sin(angle)));
  });
  const auto end = solve::follow_branch(problem, problem.scatter(start), range, callbacks);
  EXPECT_TRUE(end.completed) << end.reason;
  std::sort(passed.begin(), passed.end());
  ASSERT_EQ(passed.size(), 3U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(amplitudes[k], passed[k], 2e-3);
}
