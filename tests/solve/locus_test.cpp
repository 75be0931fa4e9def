// Curves of bifurcations in two parameters that are known exactly, and their points of codimension two.

#include <gtest/gtest.h>

#include "branch_support.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"

using namespace whirl;
using Eigen::VectorXd;
using test::Column;

namespace {

// Every system here has its second parameter q outside.

// About the equilibrium x_2 = 0.2 + p, x_0 = x_2: z' = (p - q^2 + (1.5 + q) i) z + (q - 0.5) |z|^2 z.
struct Hopf {
  const double* q;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T a = x(0) - x(2), b = x(1), r = a * a + b * b, growth = p - *q * *q + (*q - 0.5) * r;
    const double omega = 1.5 + *q;
    Column<T> f(3);
    f << xdot(0) - xdot(2) - (growth * a - omega * b), xdot(1) - (growth * b + omega * a), xdot(2) + x(2) - 0.2 - p;
    return f;
  }
};

// x' = p + q x - x^3, y' = -y: folds at q = 3 x^2, p = -2 x^3, and a cusp at 0.
struct Fold {
  const double* q;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(2);
    f << xdot(0) - (p + *q * x(0) - x(0) * x(0) * x(0)), xdot(1) + x(1);
    return f;
  }
};

// The same in a frame that turns with the shaft: folds of forced cycles. The speed is 2.
struct TurningFold {
  const double* q;
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const double c = std::cos(angle), s = std::sin(angle);
    const T a = c * x(0) + s * x(1), b = c * x(1) - s * x(0), da = p + *q * a - a * a * a, db = -b;
    Column<T> f(2);
    f << xdot(0) + 2.0 * x(1) - (c * da - s * db), xdot(1) - 2.0 * x(0) - (s * da + c * db);
    return f;
  }
};

// Self-excited cycles p = r^4 - q r^2: folds at r^2 = q/2, p = -q^2/4.
struct Bautin {
  const double* q;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T r = x(0) * x(0) + x(1) * x(1), g = p + *q * r - r * r;
    Column<T> f(2);
    f << xdot(0) - (g * x(0) - x(1)), xdot(1) - (g * x(1) + x(0));
    return f;
  }
};

// In a frame that turns by half the shaft's angle a' = (p - q^2/4) a + (q - 0.5) a^3, b' = -b: after one turn of the
// shaft (speed 2) the signs change, so that x = 0 flips at p = q^2/4.
struct Flip {
  const double* q;
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const double c = std::cos(angle / 2), s = std::sin(angle / 2);
    const T a = c * x(0) + s * x(1), b = c * x(1) - s * x(0);
    const T da = (p - *q * *q / 4) * a + (*q - 0.5) * a * a * a, db = -b;
    Column<T> f(2);
    f << xdot(0) + x(1) - (c * da - s * db), xdot(1) - x(0) - (s * da + c * db);
    return f;
  }
};

// x'' + 0.2 x' + x + cubic x^3 = q cos(angle); p is the speed.
struct Oscillator {
  const double* q;
  double cubic;
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T) const {
    Column<T> f(2);
    f << xdot(0) - x(1), xdot(1) + 0.2 * x(1) + x(0) + cubic * x(0) * x(0) * x(0) - *q * std::cos(angle);
    return f;
  }
};

// z' = (p + i) z - (1 + q i) |z|^2 z: radius sqrt(p), frequency 1 - p q.
struct Whirl {
  const double* q;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T r = x(0) * x(0) + x(1) * x(1), growth = p - r, turn = 1.0 - *q * r;
    Column<T> f(2);
    f << xdot(0) - (growth * x(0) - turn * x(1)), xdot(1) - (growth * x(1) + turn * x(0));
    return f;
  }
};

struct Point {
  double p, q;
  VectorXd inner;
};

struct Curve {
  std::vector<Point> points;
  std::vector<solve::LocatedZero> zeros;
  std::vector<double> first;  // p at the zeros
  std::vector<std::string> names;
};

struct Follow {
  double* q;
  double to, back;
  std::function<double(Vec u, const VectorXd& inner)> monitor = nullptr;  // beside the condition's own
  std::function<void(Vec u)> moved = nullptr;                             // at each accepted point
};

Curve curve(solve::ExtendedProblem& branch, solve::Condition& condition, core::Vector u, const Follow& f) {
  const core::Vector along = solve::any_tangent(branch, u.get());
  solve::AugmentedProblem problem(branch, condition, along.get(),
                                  solve::SecondParameter{[&](double value) { *f.q = value; }, 1});
  core::Vector start = problem.make_unknown();
  problem.join(u.get(), condition.start(), *f.q, start.get());
  problem.prime(start.get());
  solve::ContinuationOptions o = test::range(*f.q, f.to, 0.11);
  o.back = f.back;
  o.newton.tolerance = 1e-11;
  Curve c;
  solve::BranchCallbacks callbacks;
  callbacks.monitors = [&](Vec whole, Vec) {
    std::vector<double> values;
    c.names.clear();
    for (const auto& test : problem.tests()) {
      c.names.emplace_back(test.name);
      values.push_back(test.value);
    }
    if (f.monitor) {
      c.names.emplace_back("monitor");
      values.push_back(f.monitor(problem.branch_part(whole).get(), problem.inner(whole)));
    }
    return values;
  };
  callbacks.on_event = [](const solve::LocatedEvent&, Vec) {};
  callbacks.on_zero = [&](const solve::LocatedZero& zero, Vec whole) {
    c.zeros.push_back(zero);
    c.first.push_back(problem.first_parameter(whole));
  };
  callbacks.on_point = [&](const solve::BranchPoint& point, Vec whole) {
    c.points.push_back({problem.first_parameter(whole), point.parameter, problem.inner(whole)});
    problem.update();
  };
  callbacks.checkpoint = [&](const solve::ResumePoint&, Vec whole, Vec) {
    if (f.moved) f.moved(problem.branch_part(whole).get());
    return c.points.size() < 200;
  };
  const auto end = solve::follow_branch(problem, std::move(start), o, callbacks);
  EXPECT_GT(c.points.size(), 5U) << end.reason;
  return c;
}

}  // namespace

TEST(Locus, HopfPointsAndWhereTheyTurnSubcritical) {
  double q = 0;
  test::SmallSystem s(PETSC_COMM_WORLD, 3, 0, 1, Hopf{&q});
  solve::EquilibriumProblem problem(s, 1, 1);
  core::Vector u = problem.make_unknown();
  problem.from_state(s.vector(VectorXd(Eigen::Vector3d(0.2, 0, 0.2))).get(), 0, u.get());
  const auto condition = solve::make_hopf(s, problem, 1.5);
  const auto lyapunov = [&](Vec at, const VectorXd& inner) {
    const core::Vector x = s.vector(VectorXd::Zero(3));
    problem.to_state(at, x.get());
    return solve::hopf_coefficient(s, x.get(), inner(0));
  };
  const Curve c = curve(problem, *condition, std::move(u), {&q, 1, -1, lyapunov});
  for (const Point& at : c.points) {
    EXPECT_NEAR(at.p, at.q * at.q, 1e-9);
    EXPECT_NEAR(std::abs(at.inner(0)), 1.5 + at.q, 1e-9);
  }
  ASSERT_EQ(c.zeros.size(), 1U);
  EXPECT_EQ(c.names[c.zeros[0].monitor], "monitor");
  EXPECT_NEAR(c.zeros[0].parameter, 0.5, 1e-6);
  EXPECT_NEAR(c.first[0], 0.25, 1e-6);
}

TEST(Locus, FoldsOfEquilibriaThroughTheirCusp) {
  double q = 1;
  const double x = -std::sqrt(1.0 / 3);
  test::SmallSystem s(PETSC_COMM_WORLD, 2, 0, 1, Fold{&q});
  solve::EquilibriumProblem problem(s, 1, 1);
  core::Vector u = problem.make_unknown();
  problem.from_state(s.vector(VectorXd(Eigen::Vector2d(x, 0))).get(), -2 * x * x * x, u.get());
  const auto condition = solve::make_fold(problem, problem);
  const Curve c = curve(problem, *condition, std::move(u), {&q, -1, 1.5});
  double low = 1, high = -1;
  for (const Point& at : c.points) {
    const double exact = 2 * std::pow(std::max(at.q, 0.0) / 3, 1.5);
    EXPECT_NEAR(std::abs(at.p), exact, 1e-8);
    low = std::min(low, at.p);
    high = std::max(high, at.p);
  }
  EXPECT_LT(low, -0.3);  // on both sides of the cusp
  EXPECT_GT(high, 0.3);
  ASSERT_EQ(c.zeros.size(), 1U);
  EXPECT_EQ(c.names[c.zeros[0].monitor], "cusp");
  EXPECT_NEAR(c.zeros[0].parameter, 0, 1e-8);
  EXPECT_NEAR(c.first[0], 0, 1e-8);
}

TEST(Locus, FoldsOfForcedCycles) {
  double q = 1;
  const double x = -std::sqrt(1.0 / 3);
  test::SmallSystem s(PETSC_COMM_SELF, 2, 0, 2, TurningFold{&q});
  solve::CycleOptions o;
  o.degree = 4;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(24));
  const auto turning = [x](double a) { return VectorXd(x * Eigen::Vector2d(std::cos(a), std::sin(a))); };
  const auto guess = test::sampled(problem.scheme(), problem.mesh(), test::two_pi / 2, -2 * x * x * x, turning);
  core::Vector u = problem.scatter(guess);
  (void)solve::any_tangent(problem, u.get());
  const auto condition = solve::make_cyclic_fold(problem);
  const Curve c = curve(problem, *condition, std::move(u), {&q, 2, 0.5});
  for (const Point& at : c.points) EXPECT_NEAR(at.p, 2 * std::pow(at.q / 3, 1.5), 1e-8);
  EXPECT_GT(c.points.back().q, 1.9);
  EXPECT_TRUE(c.zeros.empty());
}

TEST(Locus, FoldsOfSelfExcitedCycles) {
  double q = 1;
  const double r = std::sqrt(0.5);
  test::SmallSystem s(PETSC_COMM_SELF, 2, -0.25, 1, Bautin{&q});
  solve::CycleOptions o;
  o.degree = 4;
  o.autonomous = true;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(16));
  const auto cycle = test::sampled(problem.scheme(), problem.mesh(), test::two_pi, -0.25,
                                   [r](double a) { return VectorXd(r * Eigen::Vector2d(std::cos(a), std::sin(a))); });
  problem.set_phase_reference(cycle);
  core::Vector u = problem.scatter(cycle);
  (void)solve::any_tangent(problem, u.get());
  const auto condition = solve::make_cyclic_fold(problem);
  const Curve c = curve(problem, *condition, std::move(u),
                        {&q, 2, 0.5, nullptr, [&](Vec at) { problem.set_phase_reference(problem.gather(at)); }});
  for (const Point& at : c.points) EXPECT_NEAR(at.p, -at.q * at.q / 4, 1e-7);  // the error of the mesh
  EXPECT_GT(c.points.back().q, 1.9);
}

TEST(Locus, FlipsAndWhereTheyTurnSubcritical) {
  double q = 0;
  test::SmallSystem s(PETSC_COMM_SELF, 2, 0, 2, Flip{&q});
  solve::CycleOptions o;
  o.degree = 4;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(12));
  core::Vector u = problem.make_unknown();
  (void)solve::any_tangent(problem, u.get());
  const auto condition = solve::make_flip(problem);
  const auto coefficient = [&](Vec at, const VectorXd&) { return solve::flip_coefficient(problem, at); };
  const Curve c = curve(problem, *condition, std::move(u), {&q, 1, -1, coefficient});
  for (const Point& at : c.points) EXPECT_NEAR(at.p, at.q * at.q / 4, 1e-8);
  // The condition's own test and the coefficient itself.
  ASSERT_EQ(c.zeros.size(), 2U);
  EXPECT_EQ(c.names[c.zeros[0].monitor], solve::generalised_flip);
  EXPECT_EQ(c.names[c.zeros[1].monitor], "monitor");
  for (const auto& zero : c.zeros) EXPECT_NEAR(zero.parameter, 0.5, 1e-6);
}

namespace {

// Half of the travel of x.
const solve::CycleQuantity amplitude_of_x{
    solve::CycleQuantity::Kind::peaks, {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0)}, 0.5};

solve::LinearPlace both_states(double speed) {
  return {Eigen::MatrixXd::Identity(2, 2), Eigen::Vector2d::Zero(), speed};
}

solve::CycleOptions of_degree(int degree, bool autonomous = false) {
  solve::CycleOptions o;
  o.degree = degree;
  o.autonomous = autonomous;
  return o;
}

}  // namespace

// |x| = q/|1 - p^2 + 0.2 i p|: the curve of one amplitude turns at the resonance, below which no force suffices.
TEST(LimitCurve, ForcedCyclesOfOneAmplitude) {
  const auto force = [](double p) { return 2 * std::abs(test::Complex(1 - p * p, 0.2 * p)); };
  double q = force(0.8);
  test::SmallSystem s(PETSC_COMM_SELF, 2, 0.8, 0, Oscillator{&q, 0});
  solve::CycleProblem problem(MPI_COMM_WORLD, s, of_degree(4), solve::uniform_mesh(24));
  core::Vector u = problem.make_unknown();
  (void)test::solve_at(problem, u.get(), 0.8);
  const auto condition = solve::make_limit(problem, amplitude_of_x, 2, [&](double) { return both_states(s.speed()); });
  const Curve c = curve(problem, *condition, std::move(u), {&q, 0.2, 1});
  double low = 1;
  for (const Point& at : c.points) {
    EXPECT_NEAR(at.q, force(at.p), 1e-7);
    low = std::min(low, at.q);
  }
  EXPECT_GT(c.points.back().p, 1.1);
  EXPECT_NEAR(low, 2 * 0.2 * std::sqrt(0.99), 5e-3);  // at p^2 = 0.98, between points
}

// Cycles by themselves, on another mesh of another degree, at forces that the curve comes to.
TEST(LimitCurve, DuffingByCyclesElsewhere) {
  double q = 0.3;
  test::SmallSystem s(PETSC_COMM_SELF, 2, 0.8, 0, Oscillator{&q, 1});
  solve::CycleProblem problem(MPI_COMM_WORLD, s, of_degree(4), solve::uniform_mesh(48)),
      other(MPI_COMM_WORLD, s, of_degree(6), test::uneven_mesh(3));
  const auto path = [](const solve::CycleProblem& of, Vec u) { return both_states(1).path(of.gather(u)); };
  core::Vector u = problem.make_unknown();
  ASSERT_TRUE(test::solve_at(problem, u.get(), 0.8).converged);
  const double value = amplitude_of_x.of(problem.scheme(), path(problem, u.get()), 1).value;
  const auto condition =
      solve::make_limit(problem, amplitude_of_x, value, [&](double) { return both_states(s.speed()); });
  const Curve c = curve(problem, *condition, std::move(u), {&q, 0.6, 0.1});
  EXPECT_GT(c.points.back().q, 0.5);
  for (const Point& at : {c.points[c.points.size() / 2], c.points.back()}) {
    q = at.q;
    // From the single term a cos(angle + phase) of the same amplitude.
    const test::Complex z = at.q / test::Complex(1 + 0.75 * value * value - at.p * at.p, 0.2 * at.p);
    core::Vector v = other.scatter(test::sampled(other.scheme(), other.mesh(), 1, at.p, [&](double a) {
      const test::Complex now = std::polar(1.0, a) * z;
      return VectorXd(Eigen::Vector2d(now.real(), -at.p * now.imag()));
    }));
    other.equations_changed();
    ASSERT_TRUE(test::solve_at(other, v.get(), at.p).converged);
    const solve::Cycle there = path(other, v.get());
    double high = 0, low = 0;
    for (int k = 0; k < 20000; ++k) {
      const double x = there.at(other.scheme(), k / 20000.0)(0);
      high = std::max(high, x);
      low = std::min(low, x);
    }
    EXPECT_NEAR((high - low) / 2, value, 1e-6 * value) << at.q;
  }
}

TEST(LimitCurve, SelfExcitedCyclesOfOnePeriod) {
  for (const auto kind : {solve::CycleQuantity::Kind::period, solve::CycleQuantity::Kind::whirl_ratio}) {
    double q = 0.5;
    test::SmallSystem s(PETSC_COMM_SELF, 2, 0.2, 2, Whirl{&q});
    solve::CycleProblem problem(MPI_COMM_WORLD, s, of_degree(4, true), solve::uniform_mesh(16));
    const auto cycle = test::sampled(problem.scheme(), problem.mesh(), test::two_pi / 0.9, 0.2, [](double a) {
      return VectorXd(std::sqrt(0.2) * Eigen::Vector2d(std::cos(a), std::sin(a)));
    });
    problem.set_phase_reference(cycle);
    const double value = kind == solve::CycleQuantity::Kind::period ? test::two_pi / 0.9 : 0.9 / 2;
    const auto condition = solve::make_limit(problem, {kind, {}, 1}, value, [](double) {
      return solve::LinearPlace{{}, {}, 2};
    });
    const Curve c = curve(problem, *condition, problem.scatter(cycle),
                          {&q, 1, 0.3, nullptr, [&](Vec at) { problem.set_phase_reference(problem.gather(at)); }});
    for (const Point& at : c.points) EXPECT_NEAR(at.p * at.q, 0.1, 1e-7);  // the error of the mesh
    EXPECT_GT(c.points.back().q, 0.9);
  }
}

// Two peaks of nearly the same height, and one that wanders.
TEST(LimitCurve, AnotherPeak) {
  const solve::Scheme scheme = solve::make_scheme(4, solve::Points::radau);
  const auto mesh = solve::uniform_mesh(20);
  const auto wave = [&](double first, double phase) {
    return test::sampled(scheme, mesh, 1, 0, [=](double a) {
      return VectorXd(Eigen::Vector2d(std::cos(2 * a) + first * std::cos(a - phase), 0));
    });
  };
  const Eigen::Vector2d x(1, 0);
  const auto before = solve::peak_of(scheme, wave(0.2, 0), x), now = solve::peak_of(scheme, wave(-0.2, 0), x);
  EXPECT_NEAR(before.value, 1.2, 1e-5);
  EXPECT_NEAR(std::remainder(before.time, 1.0), 0, 1e-3);
  EXPECT_NEAR(now.time, 0.5, 1e-3);
  EXPECT_TRUE(solve::another_peak(scheme, wave(-0.2, 0), x, now, before.time, 1e-3));
  // cos(a - 0.3) drags the peak with it.
  const auto moved = solve::peak_of(scheme, wave(3, 0.3), x);
  EXPECT_GT(std::remainder(moved.time, 1.0), 0.01);
  EXPECT_FALSE(solve::another_peak(scheme, wave(3, 0.3), x, moved, before.time, 1e-3));
}
