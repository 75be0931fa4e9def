// A branch item by item.

#include <gtest/gtest.h>

#include <variant>

#include "branch_support.hpp"

using namespace whirl;
using test::Column;

namespace {

// x^2 + p = 0 beside a follower: a fold at p = 0.
test::SmallSystem fold() {
  return test::SmallSystem(MPI_COMM_WORLD, 2, -1, 1,
                           []<class T>(double, const Column<T>& x, const Column<T>& xdot, T p) {
                             Column<T> f(2);
                             f << xdot(0) - x(0) * x(0) - p, xdot(1) + 2.0 * x(1) - x(0);
                             return f;
                           });
}

struct Walk {
  std::vector<double> points, folds;
  bool with_its_solution = false;
  solve::BranchEnd end;
};

// The branch from p = -1 through its fold; asks no more after `most` points.
Walk walk(std::size_t most) {
  test::SmallSystem s = fold();
  solve::EquilibriumProblem problem(s, 1, 1);
  test::Recorded ignored;
  const auto callbacks = test::recording(problem, ignored);
  const core::Vector x = s.vector(Eigen::Vector2d(-1, -0.5));
  core::Vector u = problem.make_unknown();
  problem.from_state(x.get(), -1, u.get());
  solve::BranchIterator branch(problem, std::move(u), test::range(-1, 1, 0.2), callbacks);
  Walk w;
  while (const auto item = branch.next()) {
    if (const auto* p = std::get_if<solve::BranchPoint>(&item->what)) {
      w.points.push_back(p->parameter);
      if (w.points.size() == most) branch.stop("enough");
    }
    if (const auto* e = std::get_if<solve::LocatedEvent>(&item->what)) {
      w.folds.push_back(e->parameter);
      w.with_its_solution = solve::last_entry(problem.comm(), item->u) == e->parameter;
    }
  }
  w.end = branch.end();
  return w;
}

}  // namespace

TEST(BranchIterator, YieldsWhatCallbacksGet) {
  const Walk w = walk(1000);
  test::SmallSystem s = fold();
  const auto r = test::follow(s, Eigen::Vector2d(-1, -0.5), test::range(-1, 1, 0.2));
  ASSERT_EQ(w.points.size(), r.points.size());
  for (std::size_t k = 0; k < w.points.size(); ++k) EXPECT_EQ(w.points[k], r.points[k].parameter) << k;
  ASSERT_EQ(w.folds.size(), 1U);
  EXPECT_NEAR(w.folds[0], 0, 1e-8);
  EXPECT_TRUE(w.with_its_solution);
  EXPECT_EQ(w.end.reason, r.end.reason);
  EXPECT_EQ(w.end.points, r.end.points);
}

TEST(BranchIterator, StopsWhereNobodyAsksOn) {
  const Walk w = walk(3);
  EXPECT_EQ(w.points.size(), 3U);
  EXPECT_EQ(w.end.points, 3);
  EXPECT_EQ(w.end.reason, "enough");
  EXPECT_FALSE(w.end.completed);
}
