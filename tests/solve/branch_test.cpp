// Branches of forced cycles with exactly known bifurcations, restarts and ranks.

#include <gtest/gtest.h>

#include <algorithm>

#include "branch_support.hpp"

using namespace whirl;
using Eigen::VectorXd;
using solve::Event;
using test::Column;

namespace {

// y = x - sin(angle) obeys y' = y^2 + p: cycles x = sin(angle) -+ sqrt(-p) with multiplier exp(-+2 sqrt(-p) T), fold at
// 0.
constexpr double speed = 2;
struct CyclicFold {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T y = x(0) - std::sin(angle);
    Column<T> f(1);
    f << xdot(0) - speed * std::cos(angle) - y * y - p;
    return f;
  }
};

// q = R(angle/2) y with y' = diag(p, -1) y: after one turn R(pi) = -1, so the multipliers are -exp(p T) and -exp(-T).
struct Flip {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const double c = std::cos(angle / 2), s = std::sin(angle / 2);
    const T y0 = c * x(0) + s * x(1), y1 = c * x(1) - s * x(0);
    Column<T> f(2);
    f << xdot(0) + 0.5 * speed * x(1) - (c * p * y0 + s * y1), xdot(1) - 0.5 * speed * x(0) - (s * p * y0 - c * y1);
    return f;
  }
};

// A Hopf normal form around a forced lag: z = (x0, x1) - lag; multipliers exp((p +- 1.3 i) T) and exp(-T).
struct NeimarkSacker {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T a = x(0) - x(2), b = x(1), q = a * a + b * b, lag = -x(2) + std::cos(angle);
    Column<T> f(3);
    f << xdot(0) - lag - (p * a - 1.3 * b - q * a), xdot(1) - (p * b + 1.3 * a - q * b), xdot(2) - lag;
    return f;
  }
};

// z' = (p + i) z + |z|^2 z - |z|^4 z: cycles p = r^4 - r^2 of period 2 pi, fold at r^2 = 1/2, p = -1/4; multiplier
// beside the trivial one exp(2 pi (2 r^2 - 4 r^4)).
struct Bautin {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T q = x(0) * x(0) + x(1) * x(1), g = p + q - q * q;
    Column<T> f(2);
    f << xdot(0) - (g * x(0) - x(1)), xdot(1) - (g * x(1) + x(0));
    return f;
  }
};

// Duffing's oscillator: two folds along the speed.
struct Duffing {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T) const {
    Column<T> f(2);
    f << xdot(0) - x(1), xdot(1) + 0.1 * x(1) + x(0) + x(0) * x(0) * x(0) - 0.15 * std::cos(angle);
    return f;
  }
};

solve::CycleOptions degree_four() {
  solve::CycleOptions o;
  o.degree = 4;
  return o;
}

const auto rest = [](int n) { return [n](double) { return VectorXd(VectorXd::Zero(n)); }; };

}  // namespace

TEST(Branch, CyclicFold) {
  test::SmallSystem s(PETSC_COMM_SELF, 1, -1, speed, CyclicFold{});
  const auto r = test::follow_cycles(
      MPI_COMM_WORLD, s, [](double a) { return VectorXd(VectorXd::Constant(1, std::sin(a) - 1)); }, degree_four(),
      solve::uniform_mesh(20), test::range(-1, 1, 0.2));
  ASSERT_EQ(r.events.size(), 1U);
  EXPECT_EQ(r.events[0].event, Event::cyclic_fold);
  EXPECT_TRUE(r.events[0].located);
  EXPECT_NEAR(r.events[0].parameter, 0, 1e-8);
  EXPECT_EQ(r.end.reason, "turned back beyond the start of its range");
  for (const auto& p : r.points) {
    const double y = (p.stability.unstable() ? 1 : -1) * std::sqrt(std::max(-p.parameter, 0.0));
    EXPECT_NEAR(std::log(std::abs(p.stability.values[0])), 2 * y * test::two_pi / speed, 1e-4);
  }
}

TEST(Branch, Flip) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, -1, speed, Flip{});
  const auto r = test::follow_cycles(MPI_COMM_WORLD, s, rest(2), degree_four(), solve::uniform_mesh(16),
                                     test::range(-0.5, 0.5, 0.3));
  EXPECT_TRUE(r.end.completed);
  ASSERT_EQ(r.events.size(), 1U);
  EXPECT_EQ(r.events[0].event, Event::flip);
  EXPECT_NEAR(r.events[0].parameter, 0, 1e-8);
  EXPECT_NEAR(std::abs(r.events[0].critical + 1.0), 0, 1e-8);
}

TEST(Branch, NeimarkSacker) {
  test::SmallSystem s(PETSC_COMM_SELF, 3, -1, speed, NeimarkSacker{});
  const auto r = test::follow_cycles(MPI_COMM_WORLD, s, rest(3), degree_four(), solve::uniform_mesh(24),
                                     test::range(-0.5, 0.5, 0.3));
  EXPECT_TRUE(r.end.completed);
  ASSERT_EQ(r.events.size(), 1U);
  EXPECT_EQ(r.events[0].event, Event::neimark_sacker);
  EXPECT_NEAR(r.events[0].parameter, 0, 1e-8);
  const double turn = 1.3 * test::two_pi / speed;
  EXPECT_NEAR(std::abs(std::arg(r.events[0].critical)), test::two_pi - turn, 1e-7);
  EXPECT_NEAR(std::abs(r.events[0].critical), 1, 1e-8);
}

// Both folds of Duffing's resonance against each other from the two ends, and the same steps on any number of ranks.
TEST(Branch, FoldsAlongTheSpeedAndRanks) {
  const auto run = [](MPI_Comm time, double from, double to) {
    test::SmallSystem s(PETSC_COMM_SELF, 2, from, 0, Duffing{});
    return test::follow_cycles(time, s, rest(2), degree_four(), solve::uniform_mesh(20), test::range(from, to, 0.15));
  };
  const auto up = run(MPI_COMM_WORLD, 0.5, 2.2), down = run(MPI_COMM_WORLD, 2.2, 0.5),
             alone = run(PETSC_COMM_SELF, 0.5, 2.2);
  EXPECT_TRUE(up.end.completed) << up.end.reason;
  EXPECT_TRUE(down.end.completed) << down.end.reason;
  const auto a = up.of(Event::cyclic_fold), b = down.of(Event::cyclic_fold);
  ASSERT_EQ(a.size(), 2U);
  ASSERT_EQ(b.size(), 2U);
  EXPECT_NEAR(a[0].parameter, b[1].parameter, 1e-8);
  EXPECT_NEAR(a[1].parameter, b[0].parameter, 1e-8);
  EXPECT_GT(a[0].parameter, a[1].parameter);
  ASSERT_EQ(up.points.size(), alone.points.size());
  for (std::size_t k = 0; k < up.points.size(); ++k) {
    EXPECT_EQ(up.points[k].newton_iterations, alone.points[k].newton_iterations);
    EXPECT_NEAR(up.points[k].step, alone.points[k].step, 1e-11);
    EXPECT_NEAR(up.points[k].parameter, alone.points[k].parameter, 1e-9);
    EXPECT_NEAR(up.norms[k], alone.norms[k], 1e-9);
  }
}

// Stopped half-way and taken up by a new problem, with adapted meshes in between.
TEST(Branch, RestartGoesOnWhereItWas) {
  auto options = test::range(0.5, 2.2, 0.15);
  options.adapt_every = 3;
  auto cycle = degree_four();
  cycle.mesh_tolerance = 1e-5;
  cycle.base_intervals = 8;
  struct Saved {
    solve::Cycle u, tangent;
    double step = 0;
    solve::BranchPoint point;
  } saved;
  test::Recorded whole, first, second;
  const auto run = [&](test::Recorded& r, int stop_at, const Saved* from) {
    test::SmallSystem s(PETSC_COMM_SELF, 2, 0.5, 0, Duffing{});
    solve::CycleProblem problem(MPI_COMM_WORLD, s, cycle, from ? from->u.mesh : solve::uniform_mesh(8));
    auto callbacks = test::recording(problem, r);
    callbacks.cycles = true;
    callbacks.stability = [&](Vec) { return test::multipliers(problem); };
    callbacks.checkpoint = [&](const solve::ResumePoint& at, Vec u, Vec t) {
      if (at.point.index != stop_at) return true;
      saved = {problem.gather(u), problem.gather(t), at.next_step, at.point};
      return false;
    };
    std::optional<solve::Restart> restart;
    core::Vector u;
    if (from)
      restart = solve::Restart{problem.scatter(from->u), problem.scatter(from->tangent), from->step, from->point, {}};
    else
      u = problem.scatter(test::sampled(problem.scheme(), problem.mesh(), 1, 0.5, rest(2)));
    r.end = solve::follow_branch(problem, std::move(u), options, callbacks, std::move(restart));
    return problem.mesh().size();
  };
  const auto mesh_of_whole = run(whole, -1, nullptr);
  (void)run(first, 9, nullptr);
  EXPECT_EQ(first.end.reason, "stopped on request");
  ASSERT_EQ(first.points.size(), 10U);
  const auto mesh_of_second = run(second, -1, &saved);
  EXPECT_EQ(mesh_of_second, mesh_of_whole);
  EXPECT_GT(mesh_of_whole, 9U);
  ASSERT_EQ(first.points.size() + second.points.size(), whole.points.size());
  EXPECT_EQ(first.events.size() + second.events.size(), whole.events.size());
  EXPECT_EQ(second.end.reason, whole.end.reason);
  for (std::size_t k = 0; k < second.points.size(); ++k) {
    EXPECT_EQ(second.points[k].index, whole.points[k + 10].index);
    EXPECT_NEAR(second.points[k].parameter, whole.points[k + 10].parameter, 1e-12);
    EXPECT_NEAR(second.norms[k], whole.norms[k + 10], 1e-12);
  }
}

// A self-excited cycle through its fold, where the critical multiplier meets the trivial one.
TEST(Branch, FoldOfASelfExcitedCycle) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 0.5, 1, Bautin{});
  auto cycle = degree_four();
  cycle.autonomous = true;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, cycle, solve::uniform_mesh(20));
  const double r0 = std::sqrt((1 + std::sqrt(3.0)) / 2);
  const auto guess = test::sampled(problem.scheme(), problem.mesh(), 6, 0.5,
                                   [r0](double a) { return VectorXd(r0 * Eigen::Vector2d(std::cos(a), std::sin(a))); });
  problem.set_phase_reference(guess);
  test::Recorded r;
  auto callbacks = test::recording(problem, r);
  callbacks.cycles = true;
  callbacks.stability = [&](Vec) {
    auto mu = spectral::eigenvalues(problem.monodromy());
    mu.erase(
        std::min_element(mu.begin(), mu.end(), [](auto a, auto b) { return std::abs(a - 1.0) < std::abs(b - 1.0); }));
    return solve::make_stability(std::move(mu), [](auto z) { return std::abs(z) - 1; });
  };
  callbacks.checkpoint = [&](const solve::ResumePoint& at, Vec u, Vec) {
    const solve::BranchPoint& p = at.point;
    const solve::Cycle c = problem.gather(u);
    const double q = c.x.col(3).squaredNorm();
    EXPECT_NEAR(c.period, test::two_pi, 1e-7);
    EXPECT_NEAR(q * q - q, p.parameter, 1e-7);
    const double exact = std::exp(test::two_pi * (2 * q - 4 * q * q));
    EXPECT_NEAR(std::abs(p.stability.values[0]), exact, 1e-4 * std::max(exact, 1.0)) << p.parameter;
    problem.set_phase_reference(c);
    return p.slope < 0 || p.parameter < -0.05;
  };
  r.end = solve::follow_branch(problem, problem.scatter(guess), test::range(0.5, -1, 0.1), callbacks);
  EXPECT_EQ(r.end.reason, "stopped on request");
  ASSERT_EQ(r.events.size(), 1U);
  EXPECT_EQ(r.events[0].event, Event::cyclic_fold);
  EXPECT_TRUE(r.events[0].located);
  EXPECT_NEAR(r.events[0].parameter, -0.25, 1e-8);
}
