// Rotation numbers that are known: maps of the circle, and flows whose two frequencies are.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "solve/cycle_systems.hpp"
#include "whirl/transient/analysis/rotation.hpp"
#include "whirl/transient/steps/integrator.hpp"
#include "whirl/transient/steps/section.hpp"

using namespace whirl;
using test::two_pi;
using transient::locked_rotation;
using transient::Ratio;
using transient::ratio_within;
using transient::rotation_number;

namespace {

using Points = std::vector<std::array<double, 2>>;

// A turn by `rho`, seen in the coordinate u -> u + bend sin(2 pi u)/(2 pi), on an ellipse that is dented and off the
// origin.
Points turned(double rho, int n, double bend, double dent = 0) {
  Points out;
  for (int i = 0; i < n; ++i) {
    const double u = 0.1 + rho * i, v = two_pi * u + bend * std::sin(two_pi * u), r = 1 + dent * std::cos(3 * v);
    out.push_back({5 + 3 * r * std::cos(v), -2 + 0.2 * r * std::sin(v)});
  }
  return out;
}

Points circle_map(double omega, double k, int discard, int n) {
  Points out;
  double theta = 0.2;
  for (int i = 0; i < discard + n; ++i) {
    theta += omega + k / two_pi * std::sin(two_pi * theta);
    if (i >= discard) out.push_back({std::cos(two_pi * theta), std::sin(two_pi * theta)});
  }
  return out;
}

TEST(Rotation, OfABentTurnIsKnown) {
  int covered = 0, all = 0;
  double worst = 0;
  for (const double rho :
       {(std::sqrt(5.0) - 1) / 2, std::sqrt(2.0) - 1, 1 / std::numbers::pi, 0.0123456, 0.987, 0.7071})
    for (const double bend : {0.0, 0.4, 0.8})
      for (const int n : {100, 240, 500}) {
        const auto r = rotation_number(turned(rho, n, bend, 0.2));
        ASSERT_TRUE(r.reason.empty()) << rho << " " << bend << " " << n << ": " << r.reason;
        const double error = std::abs(r.value - rho);
        covered += error <= r.uncertainty;
        ++all;
        if (n == 500 && rho > 0.1 && rho < 0.9) worst = std::max(worst, error);
      }
  EXPECT_EQ(covered, all);
  EXPECT_LT(worst, 1e-7);
}

// The mean of a hundred points of a plain average is right within 1e-2 of a turn; smooth weights win many digits.
TEST(Rotation, SmoothWeightsConvergeFasterThanAnyPower) {
  const double rho = (std::sqrt(5.0) - 1) / 2;
  double before = 1;
  for (const int n : {100, 200, 400, 800}) {
    const double error = std::abs(rotation_number(turned(rho, n, 0.5)).value - rho);
    EXPECT_LT(error, std::max(before / 8, 2e-14)) << n;
    before = error;
  }
}

// K = 0.9: in the tongues the map locks, and beyond K = 1 there is no circle left to go round.
TEST(Rotation, LocksInTheTonguesOfTheCircleMap) {
  const auto half = rotation_number(circle_map(0.5, 0.9, 2000, 400));
  EXPECT_NEAR(half.value, 0.5, 1e-12);
  EXPECT_EQ(half.locked.p, 1);
  EXPECT_EQ(half.locked.q, 2);
  const auto third = rotation_number(circle_map(0.345, 0.95, 2000, 400));
  EXPECT_NEAR(third.value, 1.0 / 3, 1e-10);
  EXPECT_EQ(third.locked.q, 3);
  const auto irrational = rotation_number(circle_map(0.606661, 0.5, 2000, 2000));
  EXPECT_EQ(irrational.locked.q, 0) << irrational.value;
  EXPECT_LT(irrational.uncertainty, 1e-6);
  const auto repeated = locked_rotation(circle_map(0.345, 0.95, 2000, 40), 3);
  EXPECT_EQ(repeated.locked.p, 1);
  EXPECT_EQ(repeated.locked.q, 3);
  EXPECT_EQ(repeated.uncertainty, 0);
}

// Three points on a sloping line are on no circle, though each of the two orders that rounding may find is one of a
// turn; a slightly bent line is one, and two points always are.
TEST(Rotation, OfPointsOnALineIsNone) {
  const auto three = [](double bend) {
    Points out;
    for (int i = 0; i < 8; ++i) {
      const double s = 0.1 + i % 3;
      out.push_back({1 + 0.3 * s, -2 + 0.7 * s + bend * s * s});
    }
    return out;
  };
  const auto line = locked_rotation(three(0), 3);
  EXPECT_TRUE(std::isnan(line.value)) << line.value;
  EXPECT_FALSE(line.reason.empty());
  const auto bent = locked_rotation(three(0.2), 3);
  EXPECT_TRUE(bent.value == 1.0 / 3 || bent.value == 2.0 / 3) << bent.reason;
  Points two;
  for (int i = 0; i < 4; ++i) two.push_back({i % 2 ? 1.0 : 0.0, i % 2 ? 3.0 : 0.0});
  EXPECT_EQ(locked_rotation(two, 2).value, 0.5);
}

TEST(Rotation, OfPointsInNoOrderIsNone) {
  Points chaos;  // Henon's map
  double x = 0.1, y = 0.1;
  for (int i = 0; i < 600; ++i) {
    const double next = 1 - 1.4 * x * x + y;
    y = 0.3 * x;
    x = next;
    if (i >= 100) chaos.push_back({x, y});
  }
  const auto r = rotation_number(chaos);
  EXPECT_TRUE(std::isnan(r.value));
  EXPECT_GT(r.disorder, 0.1);
  EXPECT_FALSE(r.reason.empty());
  EXPECT_TRUE(std::isnan(rotation_number(turned(0.3, 10, 0)).value));
}

TEST(Rotation, RatiosWithinABar) {
  const auto is = [](const Ratio& r, int p, int q) { return r.p == p && r.q == q; };
  EXPECT_TRUE(is(ratio_within(0.4, 1e-9), 2, 5));
  EXPECT_TRUE(is(ratio_within(5.0 / 13 + 1e-7, 1e-6), 5, 13));
  EXPECT_TRUE(is(ratio_within(1 - 1e-12, 1e-10), 1, 1));
  EXPECT_TRUE(is(ratio_within(1e-12, 1e-10), 0, 1));
  EXPECT_TRUE(is(ratio_within(0.618, 1e-2), 0, 0));  // 5/8 is within, by accident
  EXPECT_TRUE(is(ratio_within((std::sqrt(5.0) - 1) / 2, 1e-9), 0, 0));
}

// Two oscillators that do not know each other, |z|' = |z| - |z|^3 at 1 and w rad/s: on the section of the first the
// second goes round by w turns a return.
TEST(Rotation, OfTwoOscillatorsIsTheRatioOfTheirFrequencies) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the same on every rank";
  const double w = std::sqrt(2.0) - 1;
  const auto both = [w]<class T>(double, const test::Column<T>& x, const test::Column<T>& xdot, T) {
    const T p = 1.0 - x(0) * x(0) - x(1) * x(1), q = 1.0 - x(2) * x(2) - x(3) * x(3);
    test::Column<T> f(4);
    f << xdot(0) - (p * x(0) - x(1)), xdot(1) - (p * x(1) + x(0)), xdot(2) - (q * x(2) - w * x(3)),
        xdot(3) - (q * x(3) + w * x(2));
    return f;
  };
  test::SmallSystem s(PETSC_COMM_SELF, 4, 1, 1, both);
  transient::Integrator integrator(s, {1}, s.vector(Eigen::Vector4d(1, 0, 0, 1)).get(), {.tolerance = 1e-7});
  Points points;
  transient::Section section(
      integrator, [&] { return core::gather(integrator.scaled())[1] - 0.2; }, transient::CrossingSense::rising,
      [&](double) {
        const auto x = core::gather(integrator.scaled());
        points.push_back({x[2], x[3]});
      });
  for (int k = 1; k <= 8 * 60; ++k) section.advance(two_pi * k / 8);
  ASSERT_EQ(points.size(), 60U);
  const auto r = rotation_number(points);
  EXPECT_NEAR(r.value, w, r.uncertainty + 1e-6);  // beside what the integration loses
  EXPECT_LT(r.uncertainty, 1e-3);
}

// The same oscillator beside one that the shaft drives: on the points once per revolution.
TEST(Rotation, OfAForcedMotionIsItsWhirlPerRevolution) {
  if (core::size_of(MPI_COMM_WORLD) > 1) GTEST_SKIP() << "the same on every rank";
  const double speed = std::sqrt(5.0);
  const auto both = []<class T>(double angle, const test::Column<T>& x, const test::Column<T>& xdot, T) {
    const T p = 1.0 - x(0) * x(0) - x(1) * x(1);
    test::Column<T> f(4);
    f << xdot(0) - (p * x(0) - x(1)), xdot(1) - (p * x(1) + x(0)), xdot(2) - x(3),
        xdot(3) + 2.0 * x(3) + 2.0 * x(2) - std::cos(angle);
    return f;
  };
  test::SmallSystem s(PETSC_COMM_SELF, 4, speed, 0, both);
  transient::Integrator integrator(s, {speed}, s.vector(Eigen::Vector4d(1, 0, 0, 0)).get(), {.tolerance = 1e-7});
  Points points;
  for (int k = 1; k <= 70; ++k) {
    integrator.advance(two_pi / speed * k);
    const auto x = core::gather(integrator.scaled());
    if (k > 10) points.push_back({x[0] + 0.3 * x[2], x[1] + 0.2 * x[2]});
  }
  const auto r = rotation_number(points);
  EXPECT_NEAR(r.value, 1 / speed, 1e-6);
  EXPECT_EQ(r.locked.q, 0);
}

}  // namespace
