// Where branches end before the end of their range: at limits of their solutions, and at folds that natural
// continuation does not pass.

#include <gtest/gtest.h>

#include "branch_support.hpp"

using namespace whirl;
using solve::Event;
using test::Column;

namespace {

// x^2 + p = 0 beside a follower.
struct Fold {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(2);
    f << xdot(0) - x(0) * x(0) - p, xdot(1) + 2.0 * x(1) - x(0);
    return f;
  }
};

}  // namespace

TEST(NaturalContinuation, EndsAtAFoldWithTheReason) {
  test::SmallSystem s(MPI_COMM_WORLD, 2, -1, 1, Fold{});
  auto options = test::range(-1, 1, 0.2);
  options.kind = solve::Continuation::natural;
  const auto r = test::follow(s, Eigen::Vector2d(-1, -0.5), options);
  EXPECT_FALSE(r.end.completed);
  EXPECT_NE(r.end.reason.find("turns back at a fold"), std::string::npos) << r.end.reason;
  const auto folds = r.of(Event::fold);
  ASSERT_EQ(folds.size(), 1U);
  EXPECT_NEAR(folds[0].parameter, 0, 1e-8);
  // Every step goes forward, the first ones by what was asked for.
  for (std::size_t k = 1; k < r.points.size(); ++k) EXPECT_GT(r.points[k].parameter, r.points[k - 1].parameter);
  EXPECT_NEAR(r.points[1].parameter, -0.8, 1e-12);
  EXPECT_GT(r.points.back().parameter, -1e-4);
}

// Beyond a kink p = 2 x: a branch that leaves its bifurcation along x turns by 70 degrees at once, however short its
// first step. It is followed; a turn like that between two points is not.
TEST(Start, ABranchThatLeavesItsBifurcationAskewIsFollowed) {
  for (const int last : {-1, 0}) {
    test::SmallSystem s(MPI_COMM_WORLD, 2, 0, 1, []<class T>(double, const Column<T>& x, const Column<T>& xdot, T p) {
      Column<T> f(2);
      f << xdot(0) + 2.0 * x(0) - p, xdot(1) + x(1);
      return f;
    });
    solve::EquilibriumProblem problem(s, 1, 1);
    test::Recorded r;
    auto callbacks = test::recording(problem, r);
    callbacks.stability = [](Vec) { return solve::make_stability({}, [](test::Complex z) { return z.real(); }); };
    const core::Vector at = s.vector(Eigen::Vector2d::Zero()), along = s.vector(Eigen::Vector2d::UnitX());
    solve::Restart restart;
    restart.u = problem.make_unknown();
    restart.tangent = problem.make_unknown();
    problem.from_state(at.get(), 0, restart.u.get());
    problem.from_state(along.get(), 0, restart.tangent.get());
    core::check(VecScale(restart.tangent.get(),
                         1 / std::sqrt(solve::inner(problem, restart.tangent.get(), restart.tangent.get()))));
    restart.step = 0.1;
    restart.point.index = last;
    r.end = solve::follow_branch(problem, {}, test::range(0, 1, 0.1), callbacks, std::move(restart));
    EXPECT_EQ(r.end.completed, last < 0) << r.end.reason;
    if (last < 0)
      EXPECT_GE(r.points.size(), 5U);
    else
      EXPECT_NE(r.end.reason.find("turns too sharply"), std::string::npos) << r.end.reason;
  }
}

TEST(NaturalContinuation, FindsTheSameBifurcations) {
  // A Hopf normal form at p = 0.3, met in steps of the parameter.
  test::SmallSystem s(MPI_COMM_WORLD, 2, -1, 1, []<class T>(double, const Column<T>& x, const Column<T>& xdot, T p) {
    Column<T> f(2);
    f << xdot(0) - (p - 0.3) * x(0) + x(1), xdot(1) - (p - 0.3) * x(1) - x(0);
    return f;
  });
  auto options = test::range(-1, 1, 0.25);
  options.kind = solve::Continuation::natural;
  const auto r = test::follow(s, Eigen::Vector2d::Zero(), options);
  EXPECT_TRUE(r.end.completed);
  ASSERT_EQ(r.of(Event::hopf).size(), 1U);
  EXPECT_NEAR(r.events[0].parameter, 0.3, 1e-9);
  EXPECT_EQ(r.events[0].others_unstable(), 0);
  EXPECT_TRUE(r.events[0].unstable_after > 0);
}

TEST(Limit, IsLocatedAndEndsTheBranch) {
  for (const auto kind : {solve::Continuation::arclength, solve::Continuation::natural}) {
    test::SmallSystem s(MPI_COMM_WORLD, 2, -1, 1, Fold{});
    solve::EquilibriumProblem problem(s, 1, 1);
    test::Recorded r;
    auto callbacks = test::recording(problem, r);
    const core::Vector x = s.vector(Eigen::Vector2d(-1, -0.5));
    core::Vector u = problem.make_unknown();
    problem.from_state(x.get(), -1, u.get());
    // x reaches -0.4 at p = -0.16.
    callbacks.limit = [&](Vec v) {
      core::Vector at = core::duplicate(x.get());
      problem.to_state(v, at.get());
      return -0.4 - s.gather(at.get())(0);
    };
    callbacks.why = [](Vec) { return std::string("x is too large"); };
    auto options = test::range(-1, 1, 0.3);
    options.kind = kind;
    const auto end = solve::follow_branch(problem, std::move(u), options, callbacks);
    EXPECT_TRUE(end.limited);
    EXPECT_FALSE(end.completed);
    EXPECT_EQ(end.reason, "x is too large");
    EXPECT_NEAR(end.parameter, -0.16, 1e-9);
    EXPECT_LE(end.bracket, 1e-9);
    EXPECT_EQ(r.points.back().parameter, end.parameter);
    EXPECT_EQ(end.points, static_cast<int>(r.points.size()));
  }
}
