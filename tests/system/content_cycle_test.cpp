// Cycles of a rigid rotor in a film whose content is its state, by collocation: the film settles in time by itself.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/finite_rotor.hpp"
#include "support/solved_cycle.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/newton/newton.hpp"
#include "whirl/solve/shooting/shooting_problem.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

constexpr double scale = test::finite_speed_scale, speed = 0.75 * scale;

// a* = 0.1, a groove at the top under 20 kPa.
system::Train machine() {
  system::Train t = test::finite_rotor(12, 4);
  film::Reynolds film;
  film.cavitation = film::Reynolds::Cavitation::mass_conserving;
  film.states = film::Reynolds::States::dynamic;
  film.cells = {12, 4};
  film.grooves = {{std::numbers::pi / 2, std::numbers::pi / 6, 20e3}};
  t.supports[0].film = film;
  t.unbalance = {{1, 0.5 * 2.5e-6, 0}};
  return t;
}

// The equilibrium, reached from a fast rotor, whose journal runs near the middle.
solve::Cycle at_rest(system::RotorSystem& s) {
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  for (const double part : {4.0, 2.0, 1.0}) {
    s.set_parameter(part * speed);
    solve::NewtonOptions newton;
    newton.max_iterations = 40;
    const auto r = solve::find_equilibrium(s, x.get(), newton);
    EXPECT_TRUE(r.converged) << part << " " << r.reason;
  }
  s.set_forcing(true);
  const std::vector<double> whole = s.gather(x.get());
  return {{0, 1},
          Eigen::Map<const Eigen::VectorXd>(whole.data(), static_cast<Eigen::Index>(whole.size())),
          2 * std::numbers::pi / speed,
          speed};
}

using Answer = test::SolvedCycle;

template <class Problem>
Answer solved(Problem& problem, const solve::Cycle& rest) {
  solve::NewtonOptions newton;
  newton.max_iterations = 30;
  return test::solved(problem, rest, speed / scale, newton);
}

}  // namespace

// Steps of Radau IIA are intervals of collocation: the same discrete cycle, found by two ways.
TEST(ContentCycle, CollocationIsShootingByRadauSteps) {
  constexpr int n = 24;
  system::RotorSystem s(PETSC_COMM_SELF, machine(), speed);
  const solve::Cycle rest = at_rest(s);
  solve::CycleOptions options;
  options.parameter_scale = scale;
  solve::ShootingProblem shooting(PETSC_COMM_SELF, s, options, solve::radau_iia(2), n, solve::uniform_mesh(1));
  const Answer expected = solved(shooting, rest);
  solve::CycleProblem collocation(MPI_COMM_WORLD, s, options, solve::uniform_mesh(n));
  EXPECT_TRUE(collocation.settles());
  EXPECT_FALSE(shooting.settles());
  const Answer found = solved(collocation, rest);
  EXPECT_LE(found.iterations, 10);
  const double size = expected.cycle.x.cwiseAbs().maxCoeff();
  EXPECT_LE((found.cycle.x.rightCols(1) - expected.cycle.x.rightCols(1)).cwiseAbs().maxCoeff(), 1e-8 * size);
  // The film ruptures and the journal moves: not an equilibrium held for a turn.
  EXPECT_LT(rest.x.bottomRows(rest.x.rows() - 4).minCoeff(), -1e-2 * 25e-6);
  EXPECT_GT((found.cycle.x.colwise() - rest.x.col(0)).topRows(4).cwiseAbs().maxCoeff(), 1e-2 * 25e-6);
  ASSERT_FALSE(found.multipliers.empty());
  for (const auto& mu : found.multipliers) {
    if (std::abs(mu) < 1e-3) continue;
    double nearest = 1;
    for (const auto& e : expected.multipliers) nearest = std::min(nearest, std::abs(mu - e));
    EXPECT_LE(nearest, 1e-6) << mu;
  }
}

// With the orbit of the journal held, settling ends where the film's equations hold, whatever it began with.
TEST(ContentCycle, SettlesWithTheOrbitHeld) {
  system::RotorSystem s(PETSC_COMM_SELF, machine(), speed);
  const solve::Cycle rest = at_rest(s);
  solve::CycleOptions options;
  options.parameter_scale = scale;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, options, solve::uniform_mesh(12));
  const Eigen::Index states = rest.x.rows() - 4;
  solve::Cycle orbit = rest, other = rest;
  orbit.mesh = other.mesh = problem.mesh();
  orbit.x = rest.x.replicate(1, 24);
  for (Eigen::Index k = 0; k < 24; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k + 1) / 24;
    orbit.x(0, k) += 2e-6 * std::cos(angle);
    orbit.x(2, k) += 2e-6 * std::sin(angle);
  }
  other.x = orbit.x;
  other.x.bottomRows(states).setZero();
  std::vector<Eigen::MatrixXd> ends;
  for (const solve::Cycle& start : {orbit, other}) {
    core::Vector u = problem.scatter(start), r = core::duplicate(u.get());
    ASSERT_TRUE(problem.settle(u.get()));
    problem.residual(u.get(), r.get());
    const solve::Cycle end = problem.gather(u.get());
    EXPECT_LE((end.x - start.x).topRows(4).cwiseAbs().maxCoeff(), 1e-18);
    EXPECT_GT((end.x - start.x).bottomRows(states).cwiseAbs().maxCoeff(), 1e-9);
    ends.push_back(end.x);
    // Rows of the film among those of each point.
    const std::vector<double> all = core::gather(r.get());
    const auto n = static_cast<std::size_t>(rest.x.rows());
    double largest = 0;
    for (std::size_t i = 0; i + 1 < all.size(); ++i)
      if (i % n >= 4) largest = std::max(largest, std::abs(all[i]));
    EXPECT_LE(largest, 1e-9);
  }
  EXPECT_LE((ends[0] - ends[1]).cwiseAbs().maxCoeff(), 1e-9 * 25e-6);
}
