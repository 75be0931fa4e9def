// Shooting and finite differences: observed orders, agreement with collocation, exact tangents.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "cycle_systems.hpp"
#include "support/at_points.hpp"
#include "whirl/solve/shooting/shooting_problem.hpp"
#include "whirl/spectral/eigenvalues.hpp"

using namespace whirl;

namespace {

solve::Scheme points() {
  return solve::make_scheme(1, solve::Points::radau);
}

// The manufactured oscillator's states at the shooting points.
solve::Cycle solution(const solve::Tableau& tableau, int intervals, int steps) {
  const double p = 1.3;
  test::SmallSystem s(PETSC_COMM_SELF, 2, p, 0, test::ManufacturedDuffing{});
  const MPI_Comm time = intervals == 1 ? PETSC_COMM_SELF : MPI_COMM_WORLD;
  solve::ShootingProblem problem(time, s, {}, tableau, steps, solve::uniform_mesh(intervals));
  core::Vector u = problem.scatter(test::sampled(points(), problem.mesh(), test::two_pi / p, p, [p](double angle) {
    return Eigen::VectorXd(test::ManufacturedDuffing::exact(angle, p));
  }));
  const auto result = test::solve_at(problem, u.get(), p);
  EXPECT_TRUE(result.converged) << result.reason << " " << result.residual;
  return problem.gather(u.get());
}

double mesh_error(const solve::Tableau& tableau, int intervals) {
  const solve::Cycle c = solution(tableau, intervals, 1);
  double error = 0;
  for (Eigen::Index i = 0; i < c.intervals(); ++i) {
    const double angle = test::two_pi * c.mesh[static_cast<std::size_t>(i) + 1];
    error = std::max(error, (c.x.col(i) - test::ManufacturedDuffing::exact(angle, c.parameter)).cwiseAbs().maxCoeff());
  }
  return error;
}

Eigen::VectorXd end_state(const solve::Tableau& tableau, int intervals, int steps) {
  return solution(tableau, intervals, steps).x.rightCols(1);
}

}  // namespace

TEST(Shooting, ObservedOrders) {
  for (const auto& t : {solve::heun(), solve::third_order(), solve::classical(), solve::sdirk(2), solve::sdirk(4),
                        solve::radau_iia(1), solve::radau_iia(2), solve::radau_iia(3)}) {
    const int n = t.order == 1 ? 512 : t.order < 4 ? 128 : 48;
    const double coarse = mesh_error(t, n), fine = mesh_error(t, 2 * n);
    EXPECT_NEAR(std::log2(coarse / fine), t.order, 0.25)
        << t.stages() << " stages, order " << t.order << ": " << coarse << " " << fine;
    // Where the shooting points stand does not matter, but for rounding.
    EXPECT_LE((end_state(t, 4, n / 4) - end_state(t, 1, n)).cwiseAbs().maxCoeff(), 1e-11) << t.order;
  }
}

// Radau IIA steps are collocation: the same states and the same monodromy matrix.
TEST(Shooting, EqualsCollocationAtRadauPoints) {
  for (const bool autonomous : {false, true}) {
    test::SmallSystem s(PETSC_COMM_SELF, 2, autonomous ? 1.0 : 1.3, autonomous ? 1.0 : 0.0,
                        [=]<class T>(double angle, test::Column<T> x, test::Column<T> xdot, T p) {
                          return autonomous ? test::VanDerPol{}(angle, x, xdot, p)
                                            : test::ManufacturedDuffing{}(angle, x, xdot, p);
                        });
    solve::CycleOptions o;
    o.degree = 3;
    o.autonomous = autonomous;
    const auto fine = solve::uniform_mesh(48);
    solve::CycleProblem collocation(MPI_COMM_WORLD, s, o, fine);
    const double p = s.parameter();
    const auto guess =
        test::sampled(collocation.scheme(), fine, autonomous ? 6.66 : test::two_pi / p, p, [&](double a) {
          return Eigen::VectorXd(autonomous ? Eigen::Vector2d(2 * std::cos(a), -2 * std::sin(a))
                                            : test::ManufacturedDuffing::exact(a, p));
        });
    if (autonomous) collocation.set_phase_reference(guess);
    core::Vector u = collocation.scatter(guess), row = core::duplicate(u.get());
    ASSERT_TRUE(test::solve_at(collocation, u.get(), p).converged);
    solve::parameter_row(collocation, row.get());
    collocation.linearise(u.get(), row.get());
    const solve::Cycle found = collocation.gather(u.get());

    for (const int intervals : {1, 6, 48}) {
      const MPI_Comm time = intervals == 1 ? PETSC_COMM_SELF : MPI_COMM_WORLD;
      solve::ShootingProblem shooting(time, s, o, solve::radau_iia(3), 48 / intervals, solve::uniform_mesh(intervals));
      const auto at = test::at_points(collocation.scheme(), found, shooting.mesh());
      if (autonomous) shooting.set_phase_reference(at);
      // From a displaced guess, so that Newton has something to do; the phase stays that of the reference.
      solve::Cycle displaced = at;
      displaced.x *= 1.01;
      core::Vector v = shooting.scatter(displaced), w = core::duplicate(v.get());
      const auto result = test::solve_at(shooting, v.get(), p);
      EXPECT_TRUE(result.converged) << result.reason;
      solve::parameter_row(shooting, w.get());
      shooting.linearise(v.get(), w.get());
      const solve::Cycle c = shooting.gather(v.get());
      EXPECT_NEAR(c.period, found.period, 1e-11);
      EXPECT_LE((c.x - at.x).cwiseAbs().maxCoeff(), 1e-11) << intervals;
      EXPECT_LE((shooting.monodromy() - collocation.monodromy()).cwiseAbs().maxCoeff(), 1e-10) << intervals;
    }
  }
}

// van de Vrande (2001), Sec. 3.1, with the errata of the fourth-order chain and of b_T of both higher schemes.
TEST(Shooting, StepTangentsAreThoseOfTheDocument) {
  const double mu = 0.7, dt = 0.31;
  test::SmallSystem s(PETSC_COMM_SELF, 2, mu, 1, test::VanDerPol{});
  problem::ScaledPoint point(s, nullptr);
  using Vector = Eigen::Vector2d;
  using Matrix = Eigen::Matrix2d;
  const auto f = [&](const Vector& u) { return Vector(u(1), mu * (1 - u(0) * u(0)) * u(1) - u(0)); };
  const auto jacobian = [&](const Vector& u) {
    return Matrix{{0, 1}, {-2 * mu * u(0) * u(1) - 1, mu * (1 - u(0) * u(0))}};
  };
  const Vector u(1.2, -0.4);
  const Matrix one = Matrix::Identity(), j1 = jacobian(u);
  const Vector k1 = f(u);
  const auto compare = [&](const solve::Tableau& t, const Matrix& g, const Vector& b_t) {
    Eigen::VectorXd x = u;
    Eigen::MatrixXd tangents = one;
    solve::RungeKutta stepper(solve::dense_stages(point), t);
    solve::StepDerivative derivative;
    stepper.step(0, 0, dt, x, &derivative);
    derivative.carry(tangents);
    EXPECT_LE((tangents - g).cwiseAbs().maxCoeff(), 1e-14) << t.order;
    EXPECT_LE((derivative.d_length() - b_t).cwiseAbs().maxCoeff(), 1e-14) << t.order;
  };
  {
    const Vector k2 = f(u + dt * k1);
    const Matrix j2 = jacobian(u + dt * k1);
    compare(solve::heun(), dt / 2 * (j1 + j2 * (one + dt * j1)) + one, (k1 + k2 + dt * j2 * k1) / 2);
    const Vector z3 = u + dt / 4 * (k1 + k2), k3 = f(z3);
    const Matrix j3 = jacobian(z3), inner = j1 + j2 * (one + dt * j1);
    compare(solve::third_order(), dt / 6 * (inner + 4 * j3 * (one + dt / 4 * inner)) + one,
            (k1 + k2 + 4 * k3 + dt * (j2 * k1 + j3 * (k1 + k2 + dt * j2 * k1))) / 6);
  }
  const Vector z2 = u + dt / 2 * k1, k2 = f(z2), z3 = u + dt / 2 * k2, k3 = f(z3), z4 = u + dt * k3, k4 = f(z4);
  const Matrix j2 = jacobian(z2), j3 = jacobian(z3), j4 = jacobian(z4);
  const Matrix c2 = j2 * (one + dt / 2 * j1), c3 = j3 * (one + dt / 2 * c2), c4 = j4 * (one + dt * c3);
  const Vector d2 = j2 * k1 / 2, d3 = j3 * (k2 / 2 + dt / 2 * d2), d4 = j4 * (k3 + dt * d3);
  compare(solve::classical(), dt / 6 * (j1 + 2 * c2 + 2 * c3 + c4) + one,
          (k1 + 2 * k2 + 2 * k3 + k4 + dt * (2 * d2 + 2 * d3 + d4)) / 6);
}

// |R(u + h v) - R(u) - h R'(u) v| falls by four with h, with the speed and with a free period; the solve inverts.
TEST(Shooting, LinearisationPassesATaylorTest) {
  for (const bool autonomous : {false, true})
    for (const auto& t : {solve::classical(), solve::sdirk(4), solve::radau_iia(2)}) {
      test::SmallSystem s(PETSC_COMM_SELF, 2, 0.8, autonomous ? 1.0 : 0.0,
                          [=]<class T>(double angle, test::Column<T> x, test::Column<T> xdot, T p) {
                            return autonomous ? test::VanDerPol{}(angle, x, xdot, p)
                                              : test::ManufacturedDuffing{}(angle, x, xdot, p);
                          });
      solve::CycleOptions o;
      o.autonomous = autonomous;
      o.parameter_scale = 1.7;
      solve::ShootingProblem problem(MPI_COMM_WORLD, s, o, t, 5, test::uneven_mesh(0));
      const auto guess = test::sampled(
          points(), problem.mesh(), autonomous ? 6.0 : test::two_pi / 0.8, 0.8,
          [](double a) { return Eigen::VectorXd(Eigen::Vector2d(1.5 * std::cos(a), -1.1 * std::sin(a))); });
      if (autonomous) problem.set_phase_reference(guess);
      core::Vector u = problem.scatter(guess), v = core::duplicate(u.get()), row = core::duplicate(u.get()),
                   r0 = core::duplicate(u.get()), r = core::duplicate(u.get()), jv = core::duplicate(u.get());
      PetscInt begin = 0;
      core::check(VecGetOwnershipRange(u.get(), &begin, nullptr));
      {
        const core::WriteArray va(v.get());
        for (PetscInt k = 0; k < va.size(); ++k) va[k] = 0.3 * std::sin(1.0 + static_cast<double>(begin + k));
      }
      solve::parameter_row(problem, row.get());
      problem.linearise(u.get(), row.get());
      problem.multiply(v.get(), jv.get());
      solve::set_last_entry(MPI_COMM_WORLD, jv.get(), 0);
      problem.residual(u.get(), r0.get());
      double last = 0;
      for (const double h : {1e-3, 5e-4}) {
        core::Vector w = core::duplicate(u.get());
        core::check(VecWAXPY(w.get(), h, v.get(), u.get()));
        problem.residual(w.get(), r.get());
        core::check(VecAXPY(r.get(), -1, r0.get()));
        core::check(VecAXPY(r.get(), -h, jv.get()));
        solve::set_last_entry(MPI_COMM_WORLD, r.get(), 0);
        double norm = 0;
        core::check(VecNorm(r.get(), NORM_2, &norm));
        if (last > 0) {
          EXPECT_NEAR(std::log2(last / norm), 2, 0.05) << autonomous << t.order;
        }
        last = norm;
      }
      problem.multiply(v.get(), jv.get());
      problem.solve(jv.get(), r.get());
      core::check(VecAXPY(r.get(), -1, v.get()));
      double norm = 0;
      core::check(VecNorm(r.get(), NORM_2, &norm));
      EXPECT_LE(norm, 1e-10);
    }
}
