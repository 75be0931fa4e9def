// Minimally augmented systems: adjoint solves, gradients of the conditions, bifurcations located to rounding, curves of
// them in two parameters.

#include <gtest/gtest.h>

#include "branch_support.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"
#include "whirl/solve/shooting/shooting_problem.hpp"

using namespace whirl;
using Eigen::VectorXd;
using test::Column;
using test::Complex;

namespace {

constexpr double speed = 2;

// Two states in a frame that turns by half the shaft's angle: after one turn R(pi) = -1, so that the multipliers are
// minus those of a' = p a + ..., b' = -b (odd, so that the equations have the shaft's period).
struct Flip {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const double c = std::cos(angle / 2), s = std::sin(angle / 2);
    const T a = c * x(0) + s * x(1), b = c * x(1) - s * x(0), forced = 0.1 * std::cos(angle);
    const T da = p * a + 0.2 * forced * b + a * b * b - a * a * a, db = -b + a * a * a;
    Column<T> f(2);
    f << xdot(0) + 0.5 * speed * x(1) - (c * da - s * db), xdot(1) - 0.5 * speed * x(0) - (s * da + c * db);
    return f;
  }
};

// A Hopf normal form around a forced lag: z = (x0, x1) - lag; multipliers exp((p +- 1.3 i) T) and exp(-T).
struct NeimarkSacker {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T a = x(0) - x(2), b = x(1), q = a * a + b * b, lag = -x(2) + std::cos(angle);
    Column<T> f(3);
    f << xdot(0) - lag - (p * a - 1.3 * b - q * a + 0.4 * a * x(2)), xdot(1) - (p * b + 1.3 * a - q * b), xdot(2) - lag;
    return f;
  }
};

struct Duffing {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T) const {
    Column<T> f(2);
    f << xdot(0) - x(1), xdot(1) + 0.1 * x(1) + x(0) + x(0) * x(0) * x(0) - 0.15 * std::cos(angle);
    return f;
  }
};

// Self-excited cycles p = r^4 - r^2 (Bautin): fold at p = -1/4.
struct Bautin {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T q = x(0) * x(0) + x(1) * x(1), g = p + q - q * q;
    Column<T> f(2);
    f << xdot(0) - (g * x(0) - x(1)), xdot(1) - (g * x(1) + x(0));
    return f;
  }
};

// Hopf at p = 0 with frequency 1.5 about an equilibrium that moves with p, and a third state.
struct HopfAtRest {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T a = x(0) - x(2), b = x(1);
    Column<T> f(3);
    f << xdot(0) - xdot(2) - ((p + x(2) * x(2) - 0.04) * a - 1.5 * b - a * (a * a + b * b)),
        xdot(1) - (p * b + 1.5 * a + 0.3 * x(2) * b * 0.0), xdot(2) + x(2) - 0.2 - p;
    return f;
  }
};

solve::CycleOptions degree(int m) {
  solve::CycleOptions o;
  o.degree = m;
  return o;
}

const auto rest = [](int n) { return [n](double) { return VectorXd(VectorXd::Zero(n)); }; };

core::Vector generic(const solve::ExtendedProblem& problem, double phase) {
  core::Vector v = problem.make_unknown();
  PetscInt begin = 0, end = 0;
  core::check(VecGetOwnershipRange(v.get(), &begin, &end));
  const core::WriteArray a(v.get());
  for (PetscInt i = begin; i < end; ++i) a[i - begin] = 0.3 * std::sin(phase + 1.7 * i);
  return v;
}

double dot(Vec a, Vec b) {
  double value = 0;
  core::check(VecDot(a, b, &value));
  return value;
}

core::Vector moved(Vec u, double h, Vec d) {
  core::Vector v = core::duplicate(u);
  core::check(VecWAXPY(v.get(), h, d, u));
  return v;
}

// y . K^-1 x = x . K^-T y, and w . (R_u(u + h d) - R_u(u - h d)) v/2h = d . curvature(v, w).
template <class Problem>
void check_adjoint(Problem& problem, Vec u) {
  const core::Vector row = generic(problem, 0.4), x = generic(problem, 1), y = generic(problem, 2),
                     v = generic(problem, 3), w = generic(problem, 4), d = generic(problem, 5);
  core::Vector a = core::duplicate(u), b = core::duplicate(u);
  problem.linearise(u, row.get());
  problem.solve(x.get(), a.get());
  problem.solve_transposed(y.get(), b.get());
  EXPECT_NEAR(dot(y.get(), a.get()), dot(x.get(), b.get()), 1e-8 * std::abs(dot(y.get(), a.get())));
  problem.curvature(u, v.get(), w.get(), b.get());
  const double exact = dot(b.get(), d.get());
  double difference = 0;
  const double h = 1e-4;
  solve::set_last_entry(problem.comm(), w.get(), 0);
  for (const double sign : {1.0, -1.0}) {
    problem.linearise(moved(u, sign * h, d.get()).get(), row.get());
    problem.multiply(v.get(), a.get());
    difference += sign * dot(w.get(), a.get()) / (2 * h);
  }
  EXPECT_GT(std::abs(exact), 1e-3);
  EXPECT_NEAR(difference, exact, 1e-5 * std::max(1.0, std::abs(exact)));
}

// Gradients of a condition against differences of its values along a generic direction.
void check_gradient(solve::ExtendedProblem& problem, solve::Condition& condition, Vec u, Vec row) {
  const core::Vector d = generic(problem, 0.8);
  const VectorXd z = condition.start();
  const auto at = [&](double h, const VectorXd& inner) {
    const core::Vector v = moved(u, h, d.get());
    problem.linearise(v.get(), row);
    return condition.values(v.get(), inner);
  };
  (void)at(0, z);
  Eigen::MatrixXd d_inner;
  std::vector<core::Vector> gradients;
  condition.derivatives(u, z, d_inner, gradients);
  const double h = 1e-4;
  const VectorXd difference = (at(h, z) - at(-h, z)) / (2 * h);
  for (Eigen::Index k = 0; k < difference.size(); ++k) {
    const double exact = dot(gradients[static_cast<std::size_t>(k)].get(), d.get());
    EXPECT_GT(std::abs(exact), 1e-4) << k;
    EXPECT_NEAR(difference(k), exact, 2e-6 * std::max(1.0, std::abs(exact))) << k;
  }
  for (Eigen::Index j = 0; j < z.size(); ++j) {
    VectorXd up = z, down = z;
    up(j) += h;
    down(j) -= h;
    const VectorXd by_inner = (at(0, up) - at(0, down)) / (2 * h);
    for (Eigen::Index k = 0; k < by_inner.size(); ++k)
      EXPECT_NEAR(by_inner(k), d_inner(k, j), 1e-6 * std::max(1.0, std::abs(d_inner(k, j))));
  }
}

}  // namespace

TEST(Adjoint, Collocation) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 1.1, 0, Duffing{});
  solve::CycleProblem problem(MPI_COMM_WORLD, s, degree(3), test::uneven_mesh(1));
  auto u = problem.scatter(test::sampled(problem.scheme(), problem.mesh(), 1, 1.1, [](double a) {
    return VectorXd(Eigen::Vector2d(0.8 * std::cos(a), -0.7 * std::sin(a)));
  }));
  check_adjoint(problem, u.get());
}

TEST(Adjoint, SelfExcitedCollocation) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 0.1, 1, Bautin{});
  auto o = degree(3);
  o.autonomous = true;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, test::uneven_mesh(1));
  const auto cycle = test::sampled(problem.scheme(), problem.mesh(), 6, 0.1,
                                   [](double a) { return VectorXd(Eigen::Vector2d(std::cos(a), 0.9 * std::sin(a))); });
  problem.set_phase_reference(cycle);
  check_adjoint(problem, problem.scatter(cycle).get());
}

TEST(Adjoint, Shooting) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 1.1, 0, Duffing{});
  solve::ShootingProblem problem(MPI_COMM_WORLD, s, degree(1), solve::radau_iia(2), 8, solve::uniform_mesh(4));
  auto u = problem.scatter(test::sampled(problem.scheme(), problem.mesh(), 1, 1.1, [](double a) {
    return VectorXd(Eigen::Vector2d(0.8 * std::cos(a), -0.7 * std::sin(a)));
  }));
  check_adjoint(problem, u.get());
}

TEST(Adjoint, Equilibrium) {
  test::SmallSystem s(PETSC_COMM_WORLD, 3, 0.1, 1, HopfAtRest{});
  solve::EquilibriumProblem problem(s, 0.5, 1);
  check_adjoint(problem, generic(problem, 0.3).get());
}

// The remainder of the linear approximation falls with the square of the step, along a direction with a share of every
// unknown. The place depends on the parameter, too.
TEST(Condition, TaylorTestOfLimits) {
  using Kind = solve::CycleQuantity::Kind;
  const solve::CycleQuantity all[] = {{Kind::peaks, {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0)}, 0.5},
                                      {Kind::peaks, {Eigen::Vector2d::Zero()}, 1},
                                      {Kind::whirl_ratio, {}, 1}};
  test::SmallSystem s(PETSC_COMM_SELF, 2, 0.1, 1, Bautin{});
  s.set_scales(Eigen::Vector2d(0.5, 2), Eigen::Vector2d::Ones());
  for (const int m : {2, 3}) {
    auto o = degree(m);
    o.autonomous = true;
    o.parameter_scale = 0.4;
    solve::CycleProblem problem(MPI_COMM_WORLD, s, o, test::uneven_mesh(1));
    const auto cycle = test::sampled(problem.scheme(), problem.mesh(), 6, 0.1, [](double a) {
      return VectorXd(Eigen::Vector2d(std::cos(a + 0.5) + 0.3 * std::cos(2 * a), 0.9 * std::sin(a) + 0.1));
    });
    problem.set_phase_reference(cycle);
    const core::Vector u = problem.scatter(cycle), d = generic(problem, 0.8), row = generic(problem, 0.4);
    for (const solve::CycleQuantity& quantity : all) {
      const auto condition = solve::make_limit(problem, quantity, 1.7, [&](double change) {
        const double p = s.parameter() + change;
        return solve::LinearPlace{(Eigen::Matrix2d() << 1, 0.2 * p, -0.3, 2 + p * p).finished(),
                                  Eigen::Vector2d(0.1, p), 3 + p};
      });
      const auto at = [&](double h) {
        const core::Vector v = moved(u.get(), h, d.get());
        problem.linearise(v.get(), row.get());
        return condition->values(v.get(), {})(0);
      };
      const double here = at(0);
      Eigen::MatrixXd none;
      std::vector<core::Vector> gradients;
      condition->derivatives(u.get(), {}, none, gradients);
      const double slope = dot(gradients.front().get(), d.get());
      EXPECT_GT(std::abs(slope), 1e-3);
      double last = 0;
      for (const double h : {2e-3, 1e-3, 5e-4}) {
        const double left = std::abs(at(h) - here - h * slope);
        EXPECT_GT(left, 1e-10);
        if (h < 2e-3) {
          EXPECT_NEAR(last / left, 4, 0.3) << m << " " << static_cast<int>(quantity.kind);
        }
        last = left;
      }
    }
  }
}

TEST(Condition, GradientsOfCycles) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 0.1, speed, Flip{});
  solve::CycleProblem problem(MPI_COMM_WORLD, s, degree(3), test::uneven_mesh(1));
  const core::Vector u = generic(problem, 0.3), row = generic(problem, 0.4);
  problem.linearise(u.get(), row.get());
  check_gradient(problem, *solve::make_flip(problem), u.get(), row.get());
  check_gradient(problem, *solve::make_cyclic_fold(problem), u.get(), row.get());
  test::SmallSystem n(PETSC_COMM_SELF, 3, 0.1, speed, NeimarkSacker{});
  solve::CycleProblem turning(MPI_COMM_WORLD, n, degree(3), test::uneven_mesh(1));
  const core::Vector v = generic(turning, 0.3), last = generic(turning, 0.4);
  turning.linearise(v.get(), last.get());
  check_gradient(turning, *solve::make_neimark_sacker(turning, std::polar(1.0, 2.2)), v.get(), last.get());
}

TEST(Condition, GradientsOfEquilibria) {
  test::SmallSystem s(PETSC_COMM_WORLD, 3, 0.1, 1, HopfAtRest{});
  solve::EquilibriumProblem problem(s, 0.5, 1);
  const core::Vector u = generic(problem, 0.3), row = generic(problem, 0.4);
  problem.linearise(u.get(), row.get());
  check_gradient(problem, *solve::make_hopf(s, problem, 1.4), u.get(), row.get());
}

namespace {

// From a point of the branch at parameter p; the tangent there.
struct Start {
  core::Vector u, along;
};
Start at_parameter(solve::ExtendedProblem& problem, core::Vector u, double p) {
  core::Vector row = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  solve::set_last_entry(problem.comm(), u.get(), p);
  EXPECT_TRUE(solve::newton(problem, u.get(), row.get(), p, test::sharp()).converged);
  problem.linearise(u.get(), row.get());
  core::Vector along = core::duplicate(u.get());
  (void)solve::solve_linear(problem, row.get(), along.get(), "tangent_");
  core::check(VecScale(along.get(), 1 / std::sqrt(solve::inner(problem, along.get(), along.get()))));
  return {std::move(u), std::move(along)};
}

}  // namespace

TEST(Locate, FlipNeimarkSackerAndFolds) {
  {
    test::SmallSystem s(PETSC_COMM_SELF, 2, 0.2, speed, Flip{});
    solve::CycleProblem problem(MPI_COMM_WORLD, s, degree(4), solve::uniform_mesh(12));
    const Start at = at_parameter(problem, problem.make_unknown(), 0.05);
    const auto condition = solve::make_flip(problem);
    VectorXd inner;
    const auto found = solve::locate(problem, *condition, at.u.get(), at.along.get(), test::sharp(), &inner);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->parameter, 0, 1e-10);
    EXPECT_LT(found->error, 1e-10);
  }
  {
    test::SmallSystem s(PETSC_COMM_SELF, 2, 1.5, 0, Duffing{});
    solve::CycleProblem problem(MPI_COMM_WORLD, s, degree(4), solve::uniform_mesh(20));
    auto r = test::follow_cycles(MPI_COMM_WORLD, s, rest(2), degree(4), solve::uniform_mesh(20),
                                 test::range(0.5, 2.2, 0.15));
    const auto folds = r.of(solve::Event::cyclic_fold);
    ASSERT_EQ(folds.size(), 2U);
    // From the large cycle just below the upper fold.
    const double p = 0.9999 * folds[0].parameter;
    const double size = std::sqrt((p * p - 1) / 0.75);  // of the large cycle, a quarter turn behind its force
    const Start at = at_parameter(
        problem,
        problem.scatter(test::sampled(
            problem.scheme(), problem.mesh(), 1, p,
            [p, size](double a) { return VectorXd(size * Eigen::Vector2d(std::sin(a), p * std::cos(a))); })),
        p);
    const auto condition = solve::make_cyclic_fold(problem);
    VectorXd inner;
    const auto found = solve::locate(problem, *condition, at.u.get(), at.along.get(), test::sharp(), &inner);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->parameter, folds[0].parameter, 1e-9);
    EXPECT_LT(found->quadratic, 0);  // the branch lies below its upper fold
  }
  {
    test::SmallSystem s(PETSC_COMM_SELF, 3, 0.1, speed, NeimarkSacker{});
    solve::CycleProblem problem(MPI_COMM_WORLD, s, degree(4), solve::uniform_mesh(20));
    const Start at = at_parameter(problem, problem.make_unknown(), 0.1);
    const auto condition = solve::make_neimark_sacker(problem, std::polar(1.0, 2.1));
    VectorXd inner;
    const auto found = solve::locate(problem, *condition, at.u.get(), at.along.get(), test::sharp(), &inner);
    ASSERT_TRUE(found);
    problem.linearise(found->u.get(), at.along.get());
    const Complex mu = test::multipliers(problem).values.front();
    EXPECT_NEAR(std::abs(mu), 1, 1e-11);
    EXPECT_NEAR(mu.real(), inner(0), 1e-11);
  }
}

TEST(Locate, FoldOfASelfExcitedCycle) {
  test::SmallSystem s(PETSC_COMM_SELF, 2, 0.1, 1, Bautin{});
  auto o = degree(4);
  o.autonomous = true;
  solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(16));
  const double r = 0.8;
  const auto cycle = test::sampled(problem.scheme(), problem.mesh(), test::two_pi, -0.24, [r](double a) {
    return VectorXd(Eigen::Vector2d(r * std::cos(a), r * std::sin(a)));
  });
  problem.set_phase_reference(cycle);
  const Start at = at_parameter(problem, problem.scatter(cycle), -0.24);
  const auto condition = solve::make_cyclic_fold(problem);
  VectorXd inner;
  const auto found = solve::locate(problem, *condition, at.u.get(), at.along.get(), test::sharp(), &inner);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->parameter, -0.25, 1e-8);  // the error of the mesh
  EXPECT_GT(found->quadratic, 0);
}

TEST(Locate, Hopf) {
  test::SmallSystem s(PETSC_COMM_WORLD, 3, 0.1, 1, HopfAtRest{});
  solve::EquilibriumProblem problem(s, 0.5, 1);
  const Start at = at_parameter(problem, problem.make_unknown(), 0.2);
  const auto condition = solve::make_hopf(s, problem, 1.3);
  VectorXd inner;
  const auto found = solve::locate(problem, *condition, at.u.get(), at.along.get(), test::sharp(), &inner);
  ASSERT_TRUE(found);
  // x_2 = 0.2 + p at rest; trace 2 p + x_2^2 - 0.04 = 2.4 p + p^2 = 0 at p = 0, frequency 1.5.
  EXPECT_NEAR(found->parameter, 0, 1e-11);
  EXPECT_NEAR(inner(0), 1.5, 1e-11);
}
