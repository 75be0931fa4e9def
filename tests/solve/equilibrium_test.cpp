// Branches of equilibria with exactly known bifurcations, distributed by rows.

#include <gtest/gtest.h>

#include <algorithm>

#include "branch_support.hpp"

using namespace whirl;
using solve::Event;
using test::Column;

namespace {

// y' = x^2 + p beside three followers.
struct Fold {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(4);
    f << xdot(0) - x(0) * x(0) - p, xdot(1) + 2.0 * x(1) - x(0), xdot(2) + 3.0 * x(2) - x(1), xdot(3) + 4.0 * x(3) - p;
    return f;
  }
};

// Two Hopf normal forms that lose stability at p1 and p2, the second turning at omega = 3.
struct TwoHopf {
  double p1, p2;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(4);
    const T q = x(0) * x(0) + x(1) * x(1);
    f << xdot(0) - ((p - p1) * x(0) - x(1) - q * x(0)), xdot(1) - ((p - p1) * x(1) + x(0) - q * x(1)),
        xdot(2) - ((p - p2) * x(2) - 3.0 * x(3)), xdot(3) - ((p - p2) * x(3) + 3.0 * x(2));
    return f;
  }
};

Eigen::VectorXd start_of_fold(double p) {
  const double x = -std::sqrt(-p);
  return Eigen::Vector4d(x, x / 2, x / 6, p / 4);
}

}  // namespace

TEST(Equilibria, FoldIsLocatedAndPassed) {
  test::SmallSystem s(MPI_COMM_WORLD, 4, -1, 1, Fold{});
  const auto r = test::follow(s, start_of_fold(-1), test::range(-1, 1, 0.2));
  const auto folds = r.of(Event::fold);
  ASSERT_EQ(folds.size(), 1U);
  EXPECT_EQ(r.events.size(), 1U);
  EXPECT_TRUE(folds[0].located);
  EXPECT_NEAR(folds[0].parameter, 0, 1e-8);
  // Back along the unstable half.
  EXPECT_EQ(r.points.front().stability.unstable(), 0);
  EXPECT_EQ(r.points.back().stability.unstable(), 1);
  EXPECT_EQ(r.end.reason, "turned back beyond the start of its range");
  EXPECT_LT(r.points.back().parameter, -1);
  for (const auto& p : r.points) EXPECT_LE(p.parameter, 1e-12);
  // Stability x' = 2 x: the greatest eigenvalue is 2 x = -+2 sqrt(-p), next to -2, -3, -4 of the followers.
  for (const auto& p : r.points) {
    const double x = (p.stability.unstable() ? 1 : -1) * std::sqrt(-p.parameter);
    EXPECT_NEAR(p.stability.distance[0], std::max(2 * x, -2.0), 1e-7);
  }
}

TEST(Equilibria, FoldsAreReportedWithoutStabilityToo) {
  test::SmallSystem s(MPI_COMM_WORLD, 4, -1, 1, Fold{});
  solve::EquilibriumProblem problem(s, 1, 1);
  test::Recorded r;
  const auto callbacks = test::recording(problem, r);
  core::Vector u = problem.make_unknown();
  problem.from_state(s.vector(start_of_fold(-1)).get(), -1, u.get());
  (void)solve::follow_branch(problem, std::move(u), test::range(-1, 1, 0.2), callbacks);
  ASSERT_EQ(r.events.size(), 1U);
  EXPECT_NEAR(r.events[0].parameter, 0, 1e-8);
}

TEST(Equilibria, BranchPointOfAPitchforkIsReported) {
  for (const double offset : {0.0, 0.0371}) {  // 0: a point of the branch falls on the bifurcation
    test::SmallSystem s(MPI_COMM_WORLD, 3, -1, 1, [offset]<class T>(double, Column<T> x, Column<T> xdot, T p) {
      Column<T> f(3);
      f << xdot(0) - (p - offset) * x(0) + x(0) * x(0) * x(0), xdot(1) + 5.0 * x(1) - x(0), xdot(2) + x(2) - p;
      return f;
    });
    const auto r = test::follow(s, Eigen::Vector3d(0, 0, -1), test::range(-1, 1, 0.25));
    EXPECT_TRUE(r.end.completed) << r.end.reason;
    ASSERT_EQ(r.events.size(), 1U);
    EXPECT_EQ(r.events[0].event, Event::branch_point);
    EXPECT_NEAR(r.events[0].parameter, offset, 1e-6);
    EXPECT_LE(std::abs(r.events[0].critical), 1e-6);
    EXPECT_NEAR(r.events[0].sensitivity, 1, 1e-6);
  }
}

TEST(Equilibria, HopfPointOfTheNormalForm) {
  test::SmallSystem s(MPI_COMM_WORLD, 2, -1, 1, test::HopfNormalForm{});
  for (const double step : {0.3, 0.25}) {
    const auto r = test::follow(s, Eigen::Vector2d(0, 0), test::range(-1, 1, step));
    ASSERT_EQ(r.events.size(), 1U);
    EXPECT_EQ(r.events[0].event, Event::hopf);
    EXPECT_TRUE(r.events[0].located);
    EXPECT_NEAR(r.events[0].parameter, 0, 1e-8);
    EXPECT_NEAR(std::abs(r.events[0].critical.imag()), 1, 1e-8);
    EXPECT_NEAR(r.events[0].sensitivity, 1, 1e-6);
  }
}

TEST(Equilibria, TwoHopfPointsInOneStepAreBothFound) {
  for (const double p2 : {0.6, 0.22}) {
    test::SmallSystem s(MPI_COMM_WORLD, 4, -1, 1, TwoHopf{0.2, p2});
    const auto r = test::follow(s, Eigen::Vector4d::Zero(), test::range(-1, 1, 2));
    EXPECT_EQ(r.points.size(), 2U);
    ASSERT_EQ(r.events.size(), 2U);
    const double exact[] = {0.2, p2}, omega[] = {1, 3};
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(r.events[k].event, Event::hopf);
      EXPECT_NEAR(r.events[k].parameter, exact[k], 1e-8);
      EXPECT_NEAR(std::abs(r.events[k].critical.imag()), omega[k], 1e-8);
    }
  }
}

TEST(Equilibria, TheEndOfTheRangeIsHitExactlyInBothDirections) {
  test::SmallSystem s(MPI_COMM_WORLD, 4, -1, 1, Fold{});
  for (const auto& [from, to] : {std::pair(-1.0, -0.3), std::pair(-0.3, -1.0), std::pair(-1.0, -1.0 / 3)}) {
    const auto r = test::follow(s, start_of_fold(from), test::range(from, to, 0.11));
    EXPECT_TRUE(r.end.completed);
    EXPECT_EQ(r.end.reason, "reached the end of its range");
    EXPECT_NEAR(r.points.back().parameter, to, 1e-13);
    EXPECT_EQ(r.end.points, static_cast<int>(r.points.size()));
    for (std::size_t k = 0; k + 1 < r.points.size(); ++k) {
      EXPECT_EQ(r.points[k].index, static_cast<int>(k));
      EXPECT_GT(std::abs(r.points[k].parameter - to), 1e-9);  // no second point at the end
    }
  }
}

TEST(Equilibria, ABranchThatLeavesTheDomainEndsWithTheReason) {
  test::SmallSystem s(MPI_COMM_WORLD, 3, 0, 1, []<class T>(double, Column<T> x, Column<T> xdot, T p) {
    if (std::real(x(1)) > 0.6) throw core::DomainError("bearing B2: the journal touches the bore");
    Column<T> f(3);
    f << xdot(0) + x(0) - p, xdot(1) + 2.0 * x(1) - 2.0 * x(0), xdot(2) + x(2);
    return f;
  });
  const auto r = test::follow(s, Eigen::Vector3d::Zero(), test::range(0, 1, 0.1));
  EXPECT_FALSE(r.end.completed);
  EXPECT_NE(r.end.reason.find("the journal touches the bore"), std::string::npos) << r.end.reason;
  EXPECT_EQ(r.end.reason.find("the step fell below its minimum"), 0U) << r.end.reason;
  EXPECT_EQ(r.end.parameter, r.points.back().parameter);
  EXPECT_NEAR(r.points.back().parameter, 0.6, 1e-5);
}

TEST(Equilibria, OtherEnds) {
  test::SmallSystem s(MPI_COMM_WORLD, 4, -1, 1, Fold{});
  auto o = test::range(-1, 1, 0.05);
  o.max_points = 7;
  auto r = test::follow(s, start_of_fold(-1), o);
  EXPECT_EQ(r.end.reason, "reached the largest number of points");
  EXPECT_FALSE(r.end.completed);
  EXPECT_EQ(r.points.size(), 7U);
  EXPECT_EQ(r.end.points, 7);
  o.from = 1;  // where there is no equilibrium
  o.to = 2;
  r = test::follow(s, Eigen::Vector4d::Ones(), o);
  EXPECT_EQ(r.end.points, 0);
  EXPECT_EQ(r.end.reason.find("no solution at the start of the branch"), 0U) << r.end.reason;
}

TEST(Equilibria, AnyNumberOfRanksTakesTheSameSteps) {
  test::SmallSystem all(MPI_COMM_WORLD, 4, -1, 1, Fold{}), one(PETSC_COMM_SELF, 4, -1, 1, Fold{});
  const auto a = test::follow(all, start_of_fold(-1), test::range(-1, 1, 0.13)),
             b = test::follow(one, start_of_fold(-1), test::range(-1, 1, 0.13));
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t k = 0; k < a.points.size(); ++k) {
    EXPECT_EQ(a.points[k].step, b.points[k].step);
    EXPECT_EQ(a.points[k].newton_iterations, b.points[k].newton_iterations);
    EXPECT_NEAR(a.points[k].parameter, b.points[k].parameter, 1e-11);
    EXPECT_NEAR(a.norms[k], b.norms[k], 1e-11);
  }
}
