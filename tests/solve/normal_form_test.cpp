// Normal-form coefficients of systems whose normal form is known because they were made from it by a change of
// coordinates y = x + quadratic terms, which leaves the coefficients alone.

#include <gtest/gtest.h>

#include "cycle_systems.hpp"
#include "support/cycle_rows.hpp"
#include "whirl/solve/bifurcation/condition.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"
#include "whirl/solve/shooting/newton_picard.hpp"

using namespace whirl;
using test::Column;
using test::Complex;

namespace {

constexpr double speed = 2;

// z' = i omega z + (re + i im) z |z|^2 for z = y0 + i y1, y = g(x): F = Dg(x) dx/dt - f(g(x)), dF/d(dx/dt) depends on
// x.
struct BentHopf {
  double re = -0.7;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T) const {
    const T y0 = x(0) + 0.5 * x(0) * x(0) - 0.3 * x(0) * x(1), y1 = x(1) + 0.4 * x(0) * x(0) + 0.2 * x(1) * x(1);
    const T d0 = (1.0 + x(0) - 0.3 * x(1)) * xdot(0) - 0.3 * x(0) * xdot(1),
            d1 = 0.8 * x(0) * xdot(0) + (1.0 + 0.4 * x(1)) * xdot(1), q = y0 * y0 + y1 * y1;
    Column<T> f(2);
    f << d0 - (-1.4 * y1 + q * (re * y0 - 0.2 * y1)), d1 - (1.4 * y0 + q * (re * y1 + 0.2 * y0));
    return f;
  }
};

// The same, bent, around a forced lag x2: over one period T the amplitude r of z shrinks by T r^3.
struct BentNeimarkSacker {
  double re = -1;
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T u = x(0) - x(2), v = x(1), lag = -x(2) + std::cos(angle), du = xdot(0) - xdot(2), dv = xdot(1);
    const T y0 = u + 0.5 * u * u - 0.3 * u * v, y1 = v + 0.4 * u * u, q = y0 * y0 + y1 * y1;
    Column<T> f(3);
    f << (1.0 + u - 0.3 * v) * du - 0.3 * u * dv - (p * y0 - 1.3 * y1 + re * q * y0),
        0.8 * u * du + dv - (p * y1 + 1.3 * y0 + re * q * y1), xdot(2) - lag;
    return f;
  }
};

// y = g(x) with a' = -a^3, b' = -b in a frame that turns by half the shaft's angle: the map over T is a -> -a + T a^3.
struct BentFlip {
  template <class T>
  Column<T> operator()(double angle, const Column<T>& x, const Column<T>& xdot, T p) const {
    const T y0 = x(0) + 0.5 * x(0) * x(0) - 0.3 * x(0) * x(1), y1 = x(1) + 0.4 * x(0) * x(0) + 0.2 * x(1) * x(1);
    const T d0 = (1.0 + x(0) - 0.3 * x(1)) * xdot(0) - 0.3 * x(0) * xdot(1),
            d1 = 0.8 * x(0) * xdot(0) + (1.0 + 0.4 * x(1)) * xdot(1);
    const double c = std::cos(angle / 2), s = std::sin(angle / 2);
    const T a = c * y0 + s * y1, b = c * y1 - s * y0, da = p * a - a * a * a, db = -b;
    Column<T> f(2);
    f << d0 + 0.5 * speed * y1 - (c * da - s * db), d1 - 0.5 * speed * y0 - (s * da + c * db);
    return f;
  }
};

void expect_neimark_sacker(solve::PeriodicProblem& problem, const problem::System& s, double re) {
  core::Vector u =
      problem.scatter(test::rows_of(test::sampled(problem.scheme(), problem.mesh(), 1, 0,
                                                  [](double a) {
                                                    // x2' = -x2 + cos(2 t)
                                                    const double lag =
                                                        (std::cos(a) + speed * std::sin(a)) / (1 + speed * speed);
                                                    return Eigen::VectorXd(Eigen::Vector3d(lag, 0, lag));
                                                  }),
                                    s));
  (void)test::solve_at(problem, u.get(), 0);
  core::Vector row = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  problem.linearise(u.get(), row.get());
  const double period = test::two_pi / speed;
  // |q|^2 = 3 over two equal entries: z = 2 sqrt(3/2) Z
  EXPECT_NEAR(solve::neimark_sacker_coefficient(problem, u.get(), std::polar(1.0, 1.3 * period)), 6 * re * period,
              1e-4 * period);
}

void expect_flip(solve::PeriodicProblem& problem) {
  const core::Vector u = problem.make_unknown();
  core::Vector row = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  problem.linearise(u.get(), row.get());
  EXPECT_NEAR(solve::flip_coefficient(problem, u.get()), 2 * test::two_pi / speed, 1e-4);
}

}  // namespace

using Joining = solve::CycleOptions::Joining;

// x = Z q + conj with |q|^2 = 2 means z = 2 Z, so that c_1 = 4 (re + i im).
TEST(NormalForm, Hopf) {
  for (const double re : {-0.7, 0.4}) {
    test::SmallSystem s(PETSC_COMM_WORLD, 2, 0, 1, BentHopf{re});
    const core::Vector rest = s.vector(Eigen::VectorXd::Zero(2));
    EXPECT_NEAR(solve::hopf_coefficient(s, rest.get(), 1.4), 4 * re, 1e-5);
    EXPECT_NEAR(solve::hopf_coefficient(s, rest.get(), 1.4, 8), 4 * re, 1e-5);
  }
}

TEST(NormalForm, NeimarkSacker) {
  for (const auto& [re, joining] : {std::pair{-1.0, Joining::dense}, {0.5, Joining::dense}, {0.5, Joining::sweeps}}) {
    test::SmallSystem s(PETSC_COMM_SELF, 3, 0, speed, BentNeimarkSacker{re});
    solve::CycleOptions o;
    o.degree = 4;
    o.joining = joining;
    solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(20));
    expect_neimark_sacker(problem, s, re);
  }
}

TEST(NormalForm, Flip) {
  for (const Joining joining : {Joining::dense, Joining::sweeps}) {
    test::SmallSystem s(PETSC_COMM_SELF, 2, 0, speed, BentFlip{});
    solve::CycleOptions o;
    o.degree = 4;
    o.joining = joining;
    solve::CycleProblem problem(MPI_COMM_WORLD, s, o, solve::uniform_mesh(16));
    expect_flip(problem);
  }
}

// M is known by its products only.
TEST(NormalForm, ByProducts) {
  test::SmallSystem circle(PETSC_COMM_SELF, 3, 0, speed, BentNeimarkSacker{0.5}),
      twice(PETSC_COMM_SELF, 2, 0, speed, BentFlip{});
  solve::NewtonPicardProblem first(circle, {}, solve::sdirk(4), 12, solve::uniform_mesh(4));
  EXPECT_FALSE(first.has_adjoint());
  EXPECT_EQ(first.condition(solve::Event::neimark_sacker, {0, 1}), nullptr);
  expect_neimark_sacker(first, circle, 0.5);
  solve::NewtonPicardProblem second(twice, {}, solve::sdirk(4), 12, solve::uniform_mesh(4));
  expect_flip(second);
}
