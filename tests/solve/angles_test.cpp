// The angle controls of the step: where they bind, the points lie as far apart as the geometry of the branch allows.

#include <gtest/gtest.h>

#include <algorithm>

#include "branch_support.hpp"

using namespace whirl;
using test::Column;

namespace {

// Equilibria x^2 + p^2 = 1: on a circle the chord of the arc 2 beta deviates by beta, and the predictor is sin(2 beta).
struct Circle {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(1);
    f << xdot(0) + x(0) * x(0) + p * p - 1.0;
    return f;
  }
};

// Equilibria (cos p, sin p): without the parameter the branch runs in a circle, whose arcs are steps of p.
struct Helix {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(2);
    f << xdot(0) + x(0) - std::cos(p), xdot(1) + x(1) - std::sin(p);
    return f;
  }
};

// Equilibria p = -1.2 x^2. The positive factor changes no solution, but sends Newton's method across the fold.
struct Parabola {
  double phase = 0;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(1);
    f << xdot(0) + (p + 1.2 * x(0) * x(0)) * (1.0 + 0.9 * sin(8.0 * x(0) + phase));
    return f;
  }
};

double longest(const test::Recorded& r, bool in_parameter) {
  double most = 0;
  for (std::size_t k = 1; k + 1 < r.points.size(); ++k)
    most =
        std::max(most, in_parameter ? r.points[k].parameter - r.points[k - 1].parameter : std::abs(r.points[k].step));
  return most;
}

}  // namespace

TEST(Angles, Beta1BoundsTheChordOnAnArc) {
  for (const double beta : {0.05, 0.1, 0.2}) {
    test::SmallSystem s(MPI_COMM_WORLD, 1, -0.8, 1, Circle{});
    auto options = test::range(-0.8, 2, 1);
    options.max_step = 1;
    options.max_points = 40;
    options.beta_1 = beta;
    const auto r = test::follow(s, Eigen::VectorXd::Constant(1, -0.6), options);
    const double step = longest(r, false);
    EXPECT_LE(step, std::sin(2 * beta) * (1 + 1e-9)) << beta;
    EXPECT_GT(step, 0.45 * std::sin(2 * beta)) << beta;
  }
}

TEST(Angles, Beta2BoundsTheChordWithoutTheParameter) {
  const auto follow = [](double beta_2) {
    test::SmallSystem s(MPI_COMM_WORLD, 2, 0, 1, Helix{});
    auto options = test::range(0, 4, 0.5);
    options.beta_2 = beta_2;
    return longest(test::follow(s, Eigen::Vector2d(1, 0), options), true);
  };
  EXPECT_GT(follow(std::numbers::pi), 0.3);
  const double bounded = follow(0.1);
  EXPECT_LE(bounded, 0.2 * (1 + 1e-9));
  EXPECT_GT(bounded, 0.09);
}

// A step that lands behind a fold, where the branch has turned by more than 120 degrees, finds a tangent that looks
// forward and leads back: the branch would be followed home again.
TEST(Angles, ASharpFoldIsPassed) {
  for (const double step : {4.2, 4.4, 4.6, 4.8})
    for (int k = 0; k < 12; ++k) {
      test::SmallSystem s(MPI_COMM_WORLD, 1, -4.8, 1, Parabola{k * std::numbers::pi / 6});
      auto options = test::range(-4.8, 1, step);
      options.back = -4.9;
      const auto r = test::follow(s, Eigen::VectorXd::Constant(1, -2), options);
      const auto folds = r.of(solve::Event::fold);
      EXPECT_TRUE(r.of(solve::Event::branch_point).empty()) << step << ", " << k;
      ASSERT_EQ(folds.size(), 1u) << step << ", " << k;
      EXPECT_NEAR(folds[0].parameter, 0, 0.1) << step << ", " << k;
      EXPECT_LT(r.points.back().slope, 0) << step << ", " << k;
    }
}
