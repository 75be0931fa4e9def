// Points between the ends of steps: they fall where a picture of the branch bends.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "branch_support.hpp"

using namespace whirl;
using Eigen::VectorXd;
using test::Column;

namespace {

// A resonance with 5 % of damping.
template <class T>
T amplitude(T p) {
  using std::sqrt;
  const T a = 1.0 - p * p, b = 0.1 * p;
  return 1.0 / sqrt(a * a + b * b);
}

// x = amplitude(p), and a pair of eigenvalues p - 1.03 +- i beside it.
struct Resonance {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(4);
    const T growth = p - 1.03;
    f << xdot(0) + x(0) - amplitude(p), xdot(1) - growth * x(1) + x(2), xdot(2) - growth * x(2) - x(1),
        xdot(3) + x(3) - 2.0 * p;
    return f;
  }
};

// x = p; one eigenvalue -1 - |p - 1|, which has a corner at 1, and one far away.
struct Corner {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(2);
    const T slope = std::real(p) < 1 ? p - 1.0 : 1.0 - p;
    f << xdot(0) + (1.0 - slope) * (x(0) - p), xdot(1) + 9.0 * x(1);
    return f;
  }
};

// Branches of a system from p = 0.54 to 1.54 whose picture shows the state `shown`.
template <class System>
test::Recorded follow(System formula, int n, int shown, double tolerance,
                      solve::Continuation kind = solve::Continuation::arclength, MPI_Comm comm = MPI_COMM_WORLD) {
  test::SmallSystem system(comm, n, 0.54, 1, formula);
  solve::EquilibriumProblem problem(system, 1, 1e-6);
  test::Recorded r;
  auto callbacks = test::recording(problem, r);
  const core::Vector x = system.vector(VectorXd::Zero(n));
  callbacks.stability = [&](Vec u) {
    problem.to_state(u, x.get());
    std::vector<test::Complex> all;
    spectral::EigenOptions o;
    o.shapes = false;
    for (const auto& mode : spectral::modes(system, x.get(), o)) {
      all.push_back(mode.lambda);
      if (mode.lambda.imag() > 0) all.push_back(std::conj(mode.lambda));
    }
    return solve::make_stability(std::move(all), [](test::Complex z) { return z.real(); });
  };
  if (shown >= 0)
    callbacks.drawn = [&, shown](Vec u) {
      problem.to_state(u, x.get());
      return std::vector<std::vector<double>>{{system.gather(x.get())(shown)}};
    };
  auto options = test::range(0.54, 1.54, 0.1);
  options.kind = kind;
  options.picture_tolerance = tolerance;
  core::Vector u = problem.make_unknown();
  problem.from_state(system.vector(VectorXd::Constant(n, 1.3)).get(), 0.54, u.get());
  r.end = solve::follow_branch(problem, std::move(u), options, callbacks);
  return r;
}

// Largest distance of the resonance from the lines between points, in units of its picture.
double drawn_error(const std::vector<solve::BranchPoint>& points) {
  double error = 0;
  const double high = amplitude(std::sqrt(1 - 0.005)) - amplitude(1.54);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const double p = points[k].parameter, dp = points[k + 1].parameter - p;
    const double dy = (amplitude(p + dp) - amplitude(p)) / high;
    for (int i = 1; i < 20; ++i) {
      const double x = i * dp / 20, y = (amplitude(p + x) - amplitude(p)) / high;
      error = std::max(error, std::abs(x * dy - y * dp) / std::hypot(dp, dy));
    }
  }
  return error;
}

}  // namespace

TEST(Fill, PointsFallWhereThePictureBends) {
  for (const auto kind : {solve::Continuation::arclength, solve::Continuation::natural}) {
    const auto bare = follow(Resonance{}, 4, -1, 0.01, kind), filled = follow(Resonance{}, 4, 0, 0.01, kind);
    EXPECT_GT(drawn_error(bare.points), 0.1);
    // At the peak half of the range is still to come, and the picture is taken to grow by the root of two.
    EXPECT_LT(drawn_error(filled.points), 0.0145);
    EXPECT_LE(filled.points.size(), 2 * bare.points.size());
    // Half of them stand in the tenth of the range around the peak.
    const auto added = std::ranges::count_if(filled.points, [](const auto& p) { return p.between; });
    const auto around = std::ranges::count_if(
        filled.points, [](const auto& p) { return p.between && std::abs(p.parameter - 1) < 0.1; });
    EXPECT_GE(2 * around, added);
    EXPECT_EQ(filled.points.back().filled, added);
    EXPECT_EQ(filled.end.points, static_cast<int>(filled.points.size()));
  }
}

TEST(Fill, StepsAndEventsStayAsTheyAre) {
  const auto bare = follow(Resonance{}, 4, -1, 0.01), filled = follow(Resonance{}, 4, 0, 0.01);
  std::vector<double> ends;
  double arclength = 0;
  for (std::size_t k = 0; k < filled.points.size(); ++k) {
    const auto& p = filled.points[k];
    EXPECT_EQ(p.index, static_cast<int>(k));
    arclength += p.step;
    if (!p.between) ends.push_back(p.parameter);
  }
  EXPECT_NEAR(arclength, 1, 5e-3);
  ASSERT_EQ(ends.size(), bare.points.size());
  for (std::size_t k = 0; k < ends.size(); ++k) EXPECT_EQ(ends[k], bare.points[k].parameter) << k;
  ASSERT_EQ(bare.events.size(), 1U);
  ASSERT_EQ(filled.events.size(), 1U);
  EXPECT_EQ(filled.events[0].parameter, bare.events[0].parameter);
  const auto after = static_cast<std::size_t>(filled.events[0].after);
  EXPECT_GT(filled.events[0].after, bare.events[0].after);
  EXPECT_LE(filled.points[after].parameter, 1.03);
  EXPECT_GE(filled.points.at(after + 1).parameter, 1.03);
}

TEST(Fill, LinesNeedNoneAndACornerFew) {
  const auto added = [](const test::Recorded& r) { return r.points.back().filled; };
  EXPECT_EQ(added(follow(Resonance{}, 4, 3, 0.01)), 0);
  EXPECT_EQ(added(follow(Resonance{}, 4, 0, 0.0)), 0);
  EXPECT_LE(added(follow(Corner{}, 2, 0, 0.01)), 4);
}

TEST(Fill, AnyNumberOfRanksAddsTheSame) {
  const auto all = follow(Resonance{}, 4, 0, 0.01),
             one = follow(Resonance{}, 4, 0, 0.01, solve::Continuation::arclength, PETSC_COMM_SELF);
  ASSERT_EQ(all.points.size(), one.points.size());
  for (std::size_t k = 0; k < all.points.size(); ++k)
    EXPECT_NEAR(all.points[k].parameter, one.points[k].parameter, 1e-12) << k;
}
