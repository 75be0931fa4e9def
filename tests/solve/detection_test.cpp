// Events that leave the count of unstable values alone: found by looking closer, or reported as suspected. Curves of
// bifurcations in two parameters.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "branch_support.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"

using namespace whirl;
using Eigen::VectorXd;
using solve::Event;
using test::Column;

namespace {

constexpr double speed = 2;

// y' = A(p) y in a frame that turns by half the shaft's angle: multipliers minus those of exp(A T).
template <class F>
struct HalfTurning {
  F rates;  // of (a, b) at p
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const double c = std::cos(angle / 2), s = std::sin(angle / 2);
    const T a = c * x(0) + s * x(1), b = c * x(1) - s * x(0);
    const auto [da, db] = rates(a, b, p);
    Column<T> f(2);
    f << xdot(0) + 0.5 * speed * x(1) - (c * da - s * db), xdot(1) - 0.5 * speed * x(0) - (s * da + c * db);
    return f;
  }
};
template <class F>
HalfTurning<F> half_turning(F rates) {
  return {rates};
}

solve::CycleOptions degree_four() {
  solve::CycleOptions o;
  o.degree = 4;
  return o;
}

struct Found : test::Recorded {
  std::vector<solve::Suspicion> suspected;
};

/// `lost` says where the search for multipliers does not converge.
template <class System>
Found follow(
    System formula, double from, double to, double step,
    const std::function<bool(double)>& lost = [](double) { return false; }) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, from, speed, formula);
  solve::CycleProblem problem(MPI_COMM_WORLD, s, degree_four(), solve::uniform_mesh(12));
  Found found;
  auto callbacks = test::recording(problem, found);
  callbacks.cycles = true;
  callbacks.stability = [&](Vec u) {
    solve::Stability out;
    out.unknown = lost(solve::last_entry(problem.comm(), u));
    return out.unknown ? out : test::multipliers(problem);
  };
  callbacks.refine = [&](const solve::LocatedEvent& e, Vec u, Vec t) {
    return solve::refine(problem, e, u, t, test::sharp());
  };
  callbacks.on_suspicion = [&](const solve::Suspicion& x) { found.suspected.push_back(x); };
  core::Vector u = problem.make_unknown();
  found.end = solve::follow_branch(problem, std::move(u), test::range(from, to, step), callbacks);
  return found;
}

std::vector<double> places(const test::Recorded& r, Event event) {
  std::vector<double> out;
  for (const auto& e : r.of(event)) out.push_back(e.parameter);
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

// A multiplier is outside for 0 < p < 0.1 only, between two points.
TEST(Detection, AValueThatComesAndGoes) {
  const auto r = follow(half_turning([](auto a, auto b, auto p) {
                          return std::pair(decltype(a)((0.0025 - (p - 0.05) * (p - 0.05)) * a), decltype(a)(-b));
                        }),
                        -1, 1, 0.3);
  for (const auto& p : r.points) EXPECT_EQ(p.stability.unstable(), 0) << p.parameter;
  const auto flips = places(r, Event::flip);
  ASSERT_EQ(flips.size(), 2U);
  EXPECT_NEAR(flips[0], 0, 1e-9);
  EXPECT_NEAR(flips[1], 0.1, 1e-9);
  EXPECT_TRUE(r.suspected.empty());
}

// Two flips at 0 and 0.8, the first one where the search for multipliers does not converge.
TEST(Detection, GoesOnWhereStabilityIsUnknown) {
  const auto r = follow(
      half_turning([](auto a, auto b, auto p) { return std::pair(decltype(a)((p * (0.8 - p)) * a), decltype(a)(-b)); }),
      -1, 1, 0.1, [](double p) { return p > -0.25 && p < 0.25; });
  EXPECT_TRUE(r.end.completed);
  const auto flips = places(r, Event::flip);
  ASSERT_EQ(flips.size(), 1U);
  EXPECT_NEAR(flips[0], 0.8, 1e-9);
  ASSERT_FALSE(r.suspected.empty());
  EXPECT_LT(r.suspected.front().from, -0.25);
  EXPECT_GT(r.suspected.back().to, 0.25);
  for (std::size_t k = 0; k + 1 < r.suspected.size(); ++k) EXPECT_EQ(r.suspected[k].to, r.suspected[k + 1].from);
  for (const auto& p : r.points) EXPECT_EQ(p.stability.unknown, p.parameter > -0.25 && p.parameter < 0.25);
}

// z' = (r(p) + i) z about x = 0, r > 0 in a window of a step only, which no point sees: a look inside finds it.
TEST(Detection, ALookBetweenTwoPoints) {
  const auto real = [](double p) {
    return p < 0.1 ? -1.0 : p < 0.12 ? 100 * (p - 0.11) : p < 0.14 ? 100 * (0.13 - p) : -1.0;
  };
  test::SmallSystem s(PETSC_COMM_SELF, 1, -1, speed, [](double, const auto& x, const auto& xdot, auto p) {
    auto f = xdot;
    f(0) += x(0) - p;
    return f;
  });
  for (const double end : {1.0, -1.0}) {
    solve::EquilibriumProblem problem(s, 1, 1);
    test::Recorded seen;
    auto callbacks = test::recording(problem, seen);
    callbacks.stability = [&](Vec u) {
      const double r = real(solve::last_entry(PETSC_COMM_SELF, u));
      return solve::make_stability({{r, 1}, {r, -1}}, [](test::Complex z) { return z.real(); });
    };
    auto options = test::range(-end, end, 0.3);
    options.location_tolerance = 1e-6;
    for (const bool looks : {false, true}) {
      seen = {};
      if (looks) options.looks = {0.1, 0.12, 0.14};
      core::Vector u = problem.make_unknown();
      (void)solve::follow_branch(problem, std::move(u), options, callbacks);
      const auto found = places(seen, Event::hopf);
      ASSERT_EQ(found.size(), looks ? 2U : 0U) << end;
      for (const auto& p : seen.points) EXPECT_EQ(p.stability.unstable(), 0) << p.parameter;
      if (!looks) continue;
      EXPECT_NEAR(found[0], 0.11, 1e-6);
      EXPECT_NEAR(found[1], 0.13, 1e-6);
    }
  }
}

// A value that jumps across the border, as those of films on a mesh do, never comes near it: the ends enclose the
// place.
TEST(Detection, AValueThatJumps) {
  constexpr double jump = 0.1234;
  test::SmallSystem s(PETSC_COMM_SELF, 2, -1, speed,
                      half_turning([](auto a, auto b, auto) { return std::pair(decltype(a)(-a), decltype(a)(-b)); }));
  solve::CycleProblem problem(MPI_COMM_WORLD, s, degree_four(), solve::uniform_mesh(12));
  test::Recorded found;
  auto callbacks = test::recording(problem, found);
  callbacks.cycles = true;
  callbacks.stability = [&](Vec u) {
    const double p = solve::last_entry(MPI_COMM_WORLD, u);
    return solve::make_stability({-1 - (p < jump ? -0.05 : 0.05) - 0.001 * p},
                                 [](test::Complex z) { return std::abs(z) - 1; });
  };
  core::Vector u = problem.make_unknown();
  auto options = test::range(-1, 1, 0.3);
  options.location_tolerance = 1e-6;
  found.end = solve::follow_branch(problem, std::move(u), options, callbacks);
  const auto flips = found.of(Event::flip);
  ASSERT_EQ(flips.size(), 1U);
  EXPECT_TRUE(flips[0].located);
  EXPECT_LE(flips[0].bracket, 1e-6);
  EXPECT_NEAR(flips[0].parameter, jump, flips[0].bracket);
}

// It comes near and goes: nothing to report.
TEST(Detection, AValueThatOnlyComesNear) {
  const auto r = follow(half_turning([](auto a, auto b, auto p) {
                          return std::pair(decltype(a)((-0.01 - (p - 0.05) * (p - 0.05)) * a), decltype(a)(-b));
                        }),
                        -1, 1, 0.3);
  EXPECT_TRUE(r.events.empty());
  EXPECT_TRUE(r.suspected.empty());
}

// One multiplier leaves at 0 and another returns at 0.03, within one step.
TEST(Detection, OppositeCrossings) {
  const auto r = follow(
      half_turning([](auto a, auto b, auto p) { return std::pair(decltype(a)(p * a), decltype(a)((0.03 - p) * b)); }),
      -1, 1, 0.3);
  const auto flips = places(r, Event::flip);
  ASSERT_EQ(flips.size(), 2U);
  EXPECT_NEAR(flips[0], 0, 1e-9);
  EXPECT_NEAR(flips[1], 0.03, 1e-9);
  EXPECT_TRUE(r.suspected.empty());
}

// A pair leaves at 0, becomes real at 0.05, and one of the two returns at 0.05635, all within one step: the count
// changes by one, which is no pair's doing.
TEST(Detection, APairOfWhichOneReturns) {
  const auto r = follow(half_turning([](auto a, auto b, auto p) {
                          return std::pair(decltype(a)(p * a + 0.5 * (p - 0.05) * b), decltype(a)(a + p * b));
                        }),
                        -1, 0.4, 0.3);
  const auto pairs = places(r, Event::neimark_sacker), flips = places(r, Event::flip);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_NEAR(pairs[0], 0, 1e-9);
  ASSERT_EQ(flips.size(), 1U);
  EXPECT_NEAR(flips[0], 0.25 - std::sqrt(0.0375), 1e-9);
  EXPECT_TRUE(r.suspected.empty());
}

// The crossings are found between the two points, and not once more when points on either side show a kink there.
TEST(Detection, OppositeCrossingsAreReportedOnce) {
  for (const double last : {0.04, 0.11, 0.17}) {
    test::SmallSystem s(PETSC_COMM_SELF, 4, -1, 1,
                        [last]<class T>(double, const Column<T>& x, const Column<T>& xdot, T p) {
                          Column<T> f(4);
                          const T in = last - p;
                          f << xdot(0) - (p * x(0) - 2.0 * x(1)), xdot(1) - (p * x(1) + 2.0 * x(0)),
                              xdot(2) - (in * x(2) - 3.0 * x(3)), xdot(3) - (in * x(3) + 3.0 * x(2));
                          return f;
                        });
    const auto r = test::follow(s, Eigen::Vector4d::Zero(), test::range(-1, 1, 0.3));
    const auto hopfs = places(r, Event::hopf);
    ASSERT_EQ(hopfs.size(), 2U) << last;
    EXPECT_NEAR(hopfs[0], 0, 1e-8);
    EXPECT_NEAR(hopfs[1], last, 1e-8);
  }
}

// At exactly the same place they cannot be told apart.
TEST(Detection, CrossingsThatCancelAreSuspected) {
  const auto r = follow(
      half_turning([](auto a, auto b, auto p) { return std::pair(decltype(a)(p * a), decltype(a)(-1.1 * p * b)); }), -1,
      1, 0.3);
  // Rounding decides whether a point between them sees one of them outside; silence would be wrong.
  EXPECT_TRUE(!r.suspected.empty() || r.events.size() == 2) << r.events.size();
  for (const auto& s : r.suspected) EXPECT_LT(s.from * s.to, 0);
}

namespace {

// p = x^3 - 0.003 x: folds at x = -+sqrt(0.001) within one step.
struct Kink {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(1);
    f << xdot(0) - (p - x(0) * x(0) * x(0) + 0.003 * x(0));
    return f;
  }
};

}  // namespace

TEST(Detection, TwoFoldsInAStep) {
  int hidden = 0;
  for (const double from : {-0.2, -0.25, -0.3}) {
    test::SmallSystem s(PETSC_COMM_WORLD, 1, from, 1, Kink{});
    const auto r = test::follow(s, VectorXd::Constant(1, -0.6), test::range(from, 0.2, 0.3));
    hidden += std::all_of(r.points.begin(), r.points.end(), [](const auto& p) { return p.slope > 0; });
    const auto folds = places(r, Event::fold);
    ASSERT_EQ(folds.size(), 2U) << from;
    const double height = 2 * 0.001 * std::sqrt(0.001);
    EXPECT_NEAR(folds[0], -height, 1e-9);
    EXPECT_NEAR(folds[1], height, 1e-9);
  }
  EXPECT_GT(hidden, 0);
}

// At the fold of p = -x^2 the critical value is told with an error in x: it passes the border before the branch turns,
// or after that, now and then in the step beside.
TEST(Detection, ACrossingBesideAFoldIsTheFold) {
  int before = 0, after = 0;
  for (const double error : {0.004, -0.004})
    for (int k = 0; k < 10; ++k) {
      const double from = -0.5 - 0.001 * k;
      test::SmallSystem s(PETSC_COMM_SELF, 1, from, 1, []<class T>(double, Column<T> x, Column<T> xdot, T p) {
        return Column<T>(Column<T>::Constant(1, xdot(0) - p - x(0) * x(0)));
      });
      solve::EquilibriumProblem problem(s, 1, 1);
      Found found;
      auto callbacks = test::recording(problem, found);
      const core::Vector x = s.vector(VectorXd::Constant(1, -std::sqrt(-from)));
      callbacks.stability = [&](Vec u) {
        problem.to_state(u, x.get());
        double at = 0;
        core::check(VecSum(x.get(), &at));
        return solve::make_stability({2 * (at + error)}, [](std::complex<double> z) { return z.real(); });
      };
      core::Vector u = problem.make_unknown();
      problem.from_state(x.get(), from, u.get());
      (void)solve::follow_branch(problem, std::move(u), test::range(from, 1, 0.1), callbacks);
      for (const auto& point : found.points) {
        before += point.slope > 0 && point.stability.unstable() > 0;
        after += point.slope < 0 && point.stability.unstable() == 0;
      }
      ASSERT_EQ(found.events.size(), 1U) << from;
      EXPECT_EQ(found.events[0].event, Event::fold);
      EXPECT_NEAR(found.events[0].parameter, 0, 1e-8);
    }
  EXPECT_GT(before, 0);
  EXPECT_GT(after, 0);
}

// Flips where det A = q - p^2 - p/2 = 0 for A = [p 1; p^2 - q, -1/2]; two of them over p meet at (-1/4, -1/16), and at
// (1/2, 1/2) the trace vanishes too: resonance 1:2.
TEST(Curve, FlipsInTwoParameters) {
  double q = 0.14;
  test::SmallSystem s(PETSC_COMM_SELF, 2, 0.2, speed, half_turning([&q](auto a, auto b, auto p) {
                        return std::pair(decltype(a)(p * a + b), decltype(a)((p * p - q) * a - 0.5 * b));
                      }));
  solve::CycleProblem branch(MPI_COMM_WORLD, s, degree_four(), solve::uniform_mesh(12));
  const core::Vector u = [&] {
    core::Vector v = branch.make_unknown();
    solve::set_last_entry(branch.comm(), v.get(), 0.2);
    return v;
  }();
  const core::Vector along = solve::any_tangent(branch, u.get());
  const auto condition = solve::make_flip(branch);
  solve::AugmentedProblem problem(branch, *condition, along.get(),
                                  solve::SecondParameter{[&q](double value) { q = value; }, 1});
  core::Vector whole = problem.make_unknown();
  problem.join(u.get(), condition->start(), 0.14, whole.get());
  std::vector<std::pair<double, double>> points, meetings, resonances;
  solve::BranchCallbacks callbacks;
  callbacks.monitors = [&](Vec, Vec) {
    std::vector<double> values;
    for (const auto& t : problem.tests())
      if (std::string(t.name) == "resonance_1_2") values.push_back(t.value);
    return values;
  };
  callbacks.on_zero = [&](const solve::LocatedZero& z, Vec v) {
    resonances.emplace_back(problem.first_parameter(v), z.parameter);
  };
  callbacks.on_event = [&](const solve::LocatedEvent& e, Vec v) {
    EXPECT_EQ(e.event, Event::fold);
    meetings.emplace_back(problem.first_parameter(v), e.parameter);
  };
  callbacks.on_point = [&](const solve::BranchPoint& p, Vec v) {
    points.emplace_back(problem.first_parameter(v), p.parameter);
    problem.update();
  };
  for (const double to : {0.9, -1.0}) {
    auto options = test::range(0.14, to, 0.15);
    options.back = to < 0 ? 0.9 : -1.0;
    core::Vector start = core::duplicate(whole.get());
    core::check(VecCopy(whole.get(), start.get()));
    problem.prime(start.get());
    const auto end = solve::follow_branch(problem, std::move(start), options, callbacks);
    EXPECT_TRUE(end.completed) << end.reason;
  }
  EXPECT_GT(points.size(), 10U);
  for (const auto& [p, second] : points) EXPECT_NEAR(second, p * p + p / 2, 1e-8);
  ASSERT_EQ(meetings.size(), 1U);
  EXPECT_NEAR(meetings[0].first, -0.25, 1e-4);  // the place of an extremum is known to the root of its value
  EXPECT_NEAR(meetings[0].second, -0.0625, 1e-8);
  ASSERT_EQ(resonances.size(), 1U);
  EXPECT_NEAR(resonances[0].first, 0.5, 1e-7);
  EXPECT_NEAR(resonances[0].second, 0.5, 1e-7);
}
