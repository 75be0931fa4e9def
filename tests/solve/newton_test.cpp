// Newton's facts: convergence, reasons, recovery from domain errors; frequency response.

#include <gtest/gtest.h>

#include <complex>

#include "branch_support.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"

using namespace whirl;
using test::Column;

namespace {

solve::NewtonResult find(test::SmallSystem& s, const Eigen::VectorXd& guess, Eigen::VectorXd& answer,
                         int iterations = 30) {
  const core::Vector x = s.vector(guess);
  solve::NewtonOptions o;
  o.max_iterations = iterations;
  const auto r = solve::find_equilibrium(s, x.get(), o);
  answer = s.gather(x.get());
  return r;
}

}  // namespace

TEST(Newton, ConvergesInSquares) {
  test::SmallSystem s(MPI_COMM_WORLD, 3, 2, 1, []<class T>(double, Column<T> x, Column<T> xdot, T p) {
    Column<T> f(3);
    f << xdot(0) + exp(x(0)) - p, xdot(1) + x(1) * x(1) * x(1) + x(1) - x(0), xdot(2) + x(2) - x(1) * x(0);
    return f;
  });
  Eigen::VectorXd x;
  const auto r = find(s, Eigen::Vector3d(1, 0, 0), x);
  EXPECT_TRUE(r.converged);
  EXPECT_LE(r.iterations, 6);
  EXPECT_LE(r.linear_iterations, r.iterations);  // the factorisation is exact
  EXPECT_LE(r.residual, 1e-10);
  EXPECT_NEAR(x(0), std::log(2.0), 1e-9);
  EXPECT_EQ(s.parameter(), 2);
}

TEST(Newton, NotConvergingIsAFactWithAReason) {
  test::SmallSystem none(MPI_COMM_WORLD, 2, 1, 1, []<class T>(double, Column<T> x, Column<T> xdot, T p) {
    Column<T> f(2);
    f << xdot(0) + x(0) * x(0) + p, xdot(1) + x(1) - x(0);
    return f;
  });
  Eigen::VectorXd found;
  auto r = find(none, Eigen::Vector2d(0.7, 0.1), found);
  EXPECT_FALSE(r.converged);
  EXPECT_FALSE(r.reason.empty());
  EXPECT_GE(r.residual, 0.5);
  r = find(none, Eigen::Vector2d(0.7, 0.1), found, 1);
  EXPECT_FALSE(r.converged);
  EXPECT_LE(r.iterations, 1);

  test::SmallSystem singular(MPI_COMM_WORLD, 2, 1, 1, []<class T>(double, Column<T> x, Column<T> xdot, T p) {
    Column<T> f(2);
    f << xdot(0) + x(0) + x(1) - p, xdot(1) + x(0) + x(1);
    return f;
  });
  r = find(singular, Eigen::Vector2d(1, 1), found);
  EXPECT_FALSE(r.converged);
  EXPECT_FALSE(r.reason.empty());
}

// log(x) = p: from x = 8 the full step leads to x < 0, outside the domain.
struct Logarithm {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    if (std::real(x(0)) <= 0) throw core::DomainError("the film is closed");
    Column<T> f(3);
    f << xdot(0) + log(x(0)) - p, xdot(1) + x(1) - x(0), xdot(2) + 2.0 * x(2) + x(1);
    return f;
  }
};

TEST(Newton, RecoversFromADomainError) {
  test::SmallSystem s(MPI_COMM_WORLD, 3, 0.2, 1, Logarithm{});
  Eigen::VectorXd x;
  auto r = find(s, Eigen::Vector3d(8, 0, 0), x);
  EXPECT_TRUE(r.converged) << r.reason;
  EXPECT_NEAR(x(0), std::exp(0.2), 1e-9);
  // A start outside the domain is not recoverable, but a fact with the film's words.
  r = find(s, Eigen::Vector3d(-1, 0, 0), x);
  EXPECT_FALSE(r.converged);
  EXPECT_NE(r.reason.find("the film is closed"), std::string::npos) << r.reason;
}

// The same on cycles, where only one rank's interval may leave the domain.
TEST(Newton, RecoversFromADomainErrorOnOneRankOfACycle) {
  test::SmallSystem s(PETSC_COMM_SELF, 1, 0.2, 3, []<class T>(double angle, Column<T> x, Column<T> xdot, T p) {
    if (std::real(x(0)) <= 0) throw core::DomainError("the film is closed");
    Column<T> f(1);
    f << xdot(0) + log(x(0)) - p * std::cos(angle);
    return f;
  });
  solve::CycleProblem problem(MPI_COMM_WORLD, s, {}, solve::uniform_mesh(12));
  const auto bump = [](double a) { return Eigen::VectorXd(Eigen::VectorXd::Constant(1, a < 1.2 ? 9.0 : 1.0)); };
  core::Vector u = problem.scatter(test::sampled(problem.scheme(), problem.mesh(), 1, 0.2, bump));
  auto r = test::solve_at(problem, u.get(), 0.2);
  EXPECT_TRUE(r.converged) << r.reason;
  const auto outside = [](double a) { return Eigen::VectorXd(Eigen::VectorXd::Constant(1, a < 0.6 ? -1.0 : 1.0)); };
  u = problem.scatter(test::sampled(problem.scheme(), problem.mesh(), 1, 0.2, outside));
  r = test::solve_at(problem, u.get(), 0.2);
  EXPECT_FALSE(r.converged);
  EXPECT_NE(r.reason.find("the film is closed"), std::string::npos) << r.reason;
}

TEST(FrequencyResponse, OfAnOscillatorInFirstOrderForm) {
  for (const double damping : {0.0, 0.2}) {
    test::SmallSystem s(MPI_COMM_WORLD, 4, 1, 1, [damping]<class T>(double, Column<T> x, Column<T> xdot, T) {
      Column<T> f(4);
      f << xdot(0) - x(2), xdot(1) - x(3), xdot(2) + damping * x(2) + 2.0 * x(0) - x(1), 3.0 * xdot(3) + x(1) - x(0);
      return f;
    });
    s.set_scales(Eigen::Vector4d(1e-3, 1e-2, 1, 10), Eigen::Vector4d(1, 2, 3, 4));
    solve::FrequencyResolvent response(s);
    const core::Vector x = s.vector(Eigen::Vector4d::Zero());
    for (const double w : {0.4, 1.7}) {
      // Force (1, -0.5 i) on the masses: (K - w^2 M + i w D) z = b.
      Eigen::Matrix2cd dynamic;
      dynamic << test::Complex(2 - w * w, w * damping), -1, -1, 1 - 3 * w * w;
      const Eigen::Vector2cd exact = dynamic.inverse() * Eigen::Vector2cd(1, test::Complex(0, -0.5));
      const std::array<test::Complex, 4> b{0, 0, 1, {0, -0.5}};
      PetscInt begin = 0, end = 0;
      core::check(VecGetOwnershipRange(x.get(), &begin, &end));
      const std::vector<test::Complex> right(b.begin() + begin, b.begin() + end);
      response.linearise(x.get());
      response.factorise({0, w});
      const std::vector<test::Complex> z = response.respond(right);
      ASSERT_EQ(z.size(), right.size());
      // (u, A^-1 v) = (A^-* u, v), with loads on the kinematic rows too.
      const Eigen::VectorXcd u = Eigen::VectorXcd::LinSpaced(4, {1, 2}, {-3, 0.5}), v = u.reverse().conjugate();
      const test::Complex product = u.dot(response.solve(v));
      EXPECT_LT(std::abs(product - response.solve_adjoint(u).dot(v)), 1e-12 * std::abs(product));
      for (PetscInt i = begin; i < end; ++i) {
        const test::Complex want = i < 2 ? exact(i) : test::Complex(0, w) * exact(i - 2);
        EXPECT_NEAR(std::abs(z[static_cast<std::size_t>(i - begin)] - want), 0, 1e-11);
      }
    }
  }
}

// No pivot stands on the diagonal: elimination without row exchanges has no answer.
TEST(FrequencyResponse, OfEquationsThatStandInAnotherOrder) {
  test::SmallSystem s(MPI_COMM_WORLD, 2, 1, 1, []<class T>(double, Column<T> x, Column<T> xdot, T) {
    Column<T> f(2);
    f << xdot(1) + 3.0 * x(1), 2.0 * xdot(0) + x(0);
    return f;
  });
  solve::FrequencyResolvent response(s);
  const core::Vector x = s.vector(Eigen::Vector2d::Zero());
  PetscInt begin = 0, end = 0;
  core::check(VecGetOwnershipRange(x.get(), &begin, &end));
  for (const double w : {0.5, 2.0}) {
    const test::Complex exact[] = {1.0 / test::Complex(1, 2 * w), 1.0 / test::Complex(3, w)};
    response.linearise(x.get());
    response.factorise({0, w});
    const auto z = response.respond(std::vector<test::Complex>(static_cast<std::size_t>(end - begin), 1.0));
    for (PetscInt i = begin; i < end; ++i)
      EXPECT_NEAR(std::abs(z[static_cast<std::size_t>(i - begin)] - exact[i]), 0, 1e-12);
  }
}
