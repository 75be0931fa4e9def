// Newton-Picard steps by the structure of a system: the numbers of the sparse path, which knows nothing of it, for all
// kinds of schemes and of films with and without states.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/film_of.hpp"
#include "support/petsc_options.hpp"
#include "system/start.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/newton.hpp"
#include "whirl/solve/shooting/newton_picard.hpp"
#include "whirl/solve/shooting/shooting_problem.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using Eigen::Index;
using Eigen::VectorXd;
using film::testing::Kind;

namespace {

constexpr double speed_scale = 160, speed = 2.2 * speed_scale;

struct Case {
  const char* name;
  Kind kind;
  film::Compliant::Differences differences;
  film::Compliant::Quadrature quadrature;
  bool two_films;  // the second one on a pedestal
};

system::Train train(const Case& c) {
  system::Train t;
  t.gravity = 0;
  t.rotor.type = rotor::Options::Type::rigid;
  t.rotor.mass = 0.5;
  t.rotor.load = 0.32;
  t.unbalance = {{1, 0.5 * 2e-6, 0}};
  system::Support s;
  s.name = "one";
  s.node = 1;
  s.geometry = {film::Geometry::Bore::cylindrical, 0.005, 0.01, 25e-6, 0, 0, 0};
  film::testing::Elastic film;
  film.compliance = 0.1;
  film.reference_speed = speed_scale;
  film.cells = {20, 4};
  film.differences = c.differences;
  film.quadrature = c.quadrature;
  film.kind = c.kind;
  if (c.kind == Kind::short_bearing)
    s.film = film::Short{};
  else
    s.film = film;
  s.lubricant = {0.001, 1000};
  t.supports = {s};
  if (!c.two_films) return t;
  s.name = "two";
  film.cells = {14, 4};
  s.film = film;
  s.has_pedestal = true;
  for (std::size_t d = 0; d < 2; ++d) {
    s.mass[d] = 0.1;
    s.stiffness[d] = 2e5;
    s.damping[d] = 20;
  }
  t.supports.push_back(s);
  return t;
}

// A motion around the equilibrium that solves nothing.
solve::Cycle motion(system::RotorSystem& s, const std::vector<double>& mesh) {
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  EXPECT_TRUE(solve::find_equilibrium(s, x.get(), newton).converged);
  s.set_forcing(true);
  core::Vector scale = core::duplicate(x.get()), rows = core::duplicate(x.get());
  s.scales(scale.get(), rows.get());
  const std::vector<double> whole = s.gather(x.get()), scales = s.gather(scale.get());
  solve::Cycle c{mesh, {}, 2 * std::numbers::pi / speed, speed};
  c.x.resize(static_cast<Index>(whole.size()), c.intervals());
  for (Index i = 0; i < c.x.cols(); ++i)
    for (Index k = 0; k < c.x.rows(); ++k) {
      const auto at = static_cast<std::size_t>(k);
      c.x(k, i) = whole[at] + 0.02 * scales[at] * std::sin(1.3 * static_cast<double>(k) + static_cast<double>(i));
    }
  return c;
}

VectorXd values(Vec v) {
  const core::ReadArray a(v);
  return Eigen::Map<const VectorXd>(a.data(), a.size());
}

using Differences = film::Compliant::Differences;
using Quadrature = film::Compliant::Quadrature;

const Case cases[] = {{"short", Kind::compliant_short, Differences::upwind, Quadrature::simpson, false},
                      {"short_central", Kind::compliant_short, Differences::central, Quadrature::sub_cell, false},
                      {"long", Kind::compliant_long, Differences::upwind, Quadrature::sub_cell, false},
                      {"short_third", Kind::compliant_short, Differences::third_order, Quadrature::sub_cell, false},
                      {"two", Kind::compliant_short, Differences::upwind, Quadrature::sub_cell, true},
                      {"rigid", Kind::short_bearing, Differences::upwind, Quadrature::sub_cell, false}};

// The sparse path solves stages by the machine's parts many times: MUMPS, made for large matrices, would take most of
// the time for calls with these small hubs.
class StructuredSteps : public testing::TestWithParam<Case> {
  const test::WithOptions small_{{{"-hub_pc_factor_mat_solver_type", "klu"}}};
};

}  // namespace

TEST_P(StructuredSteps, ResidualAndProductsAreThoseOfTheSparsePath) {
  const auto mesh = solve::uniform_mesh(3);
  for (const auto& tableau : {solve::heun(), solve::classical(), solve::sdirk(2), solve::sdirk(4)}) {
    // Of explicit schemes one is enough for a film that wants a thousand steps.
    if (tableau.is_explicit() && tableau.order > 2 && GetParam().kind == Kind::compliant_long) continue;
    SCOPED_TRACE(tableau.stages());
    system::RotorSystem s(PETSC_COMM_SELF, train(GetParam()), speed);
    const solve::Cycle c = motion(s, mesh);
    VectorXd residual[2], product[2], solved[2];
    for (const bool structured : {false, true}) {
      solve::NewtonPicardOptions options;
      options.parameter_scale = speed_scale;
      options.constant_rates = structured;
      // Explicit steps of a length at which these films are stable; long ones are stiff.
      const int steps = !tableau.is_explicit() ? 4 : GetParam().kind == Kind::compliant_long ? 1000 : 100;
      solve::NewtonPicardProblem problem(s, options, tableau, steps, mesh);
      EXPECT_EQ(problem.structured(), structured);
      core::Vector u = problem.scatter(c), row = core::duplicate(u.get()), r = core::duplicate(u.get()),
                   v = core::duplicate(u.get());
      solve::parameter_row(problem, row.get());
      problem.residual(u.get(), r.get());
      problem.linearise(u.get(), row.get());
      {
        const core::WriteArray va(v.get()), ra(r.get());
        ra[ra.size() - 1] = 0;
        for (PetscInt k = 0; k < va.size(); ++k) va[k] = std::sin(0.9 * k);
      }
      residual[structured] = values(r.get());
      problem.multiply(v.get(), r.get());
      product[structured] = values(r.get());
      (void)solve::solve_linear(problem, v.get(), r.get(), "");
      solved[structured] = values(r.get());
    }
    EXPECT_GT(residual[0].norm(), 1e-3);
    EXPECT_LE((residual[1] - residual[0]).cwiseAbs().maxCoeff(), 1e-8 * residual[0].cwiseAbs().maxCoeff());
    EXPECT_LE((product[1] - product[0]).cwiseAbs().maxCoeff(), 1e-7 * product[0].cwiseAbs().maxCoeff());
    EXPECT_LE((solved[1] - solved[0]).cwiseAbs().maxCoeff(), 1e-6 * solved[0].cwiseAbs().maxCoeff());
  }
}

// Maps and their derivatives of shooting, dense by the Jacobians of the stages and by the structure.
TEST_P(StructuredSteps, ShootingIsTheSameDense) {
  const auto mesh = solve::uniform_mesh(3);
  for (const auto& tableau : {solve::heun(), solve::sdirk(2)}) {
    SCOPED_TRACE(tableau.stages());
    system::RotorSystem s(PETSC_COMM_SELF, train(GetParam()), speed);
    const solve::Cycle c = motion(s, mesh);
    VectorXd residual[2], solved[2];
    Eigen::MatrixXd monodromy[2];
    for (const bool structured : {false, true}) {
      solve::CycleOptions options;
      options.parameter_scale = speed_scale;
      const int steps = !tableau.is_explicit() ? 4 : GetParam().kind == Kind::compliant_long ? 1000 : 100;
      solve::ShootingProblem problem(PETSC_COMM_SELF, s, options, tableau, steps, mesh, structured);
      core::Vector u = problem.scatter(c), row = core::duplicate(u.get()), r = core::duplicate(u.get()),
                   v = core::duplicate(u.get());
      solve::parameter_row(problem, row.get());
      problem.residual(u.get(), r.get());
      problem.linearise(u.get(), row.get());
      {
        const core::WriteArray va(v.get()), ra(r.get());
        ra[ra.size() - 1] = 0;
        for (PetscInt k = 0; k < va.size(); ++k) va[k] = std::sin(0.9 * k);
      }
      residual[structured] = values(r.get());
      (void)solve::solve_linear(problem, v.get(), r.get(), "");
      solved[structured] = values(r.get());
      monodromy[structured] = problem.monodromy();
    }
    EXPECT_LE((residual[1] - residual[0]).cwiseAbs().maxCoeff(), 1e-8 * residual[0].cwiseAbs().maxCoeff());
    EXPECT_LE((solved[1] - solved[0]).cwiseAbs().maxCoeff(), 1e-6 * solved[0].cwiseAbs().maxCoeff());
    EXPECT_LE((monodromy[1] - monodromy[0]).cwiseAbs().maxCoeff(), 1e-7 * monodromy[0].cwiseAbs().maxCoeff());
  }
}

// Multipliers from the subspace that is there, at neighbouring points, against all of the dense monodromy matrix.
TEST_P(StructuredSteps, MultipliersFollowTheDenseOnes) {
  const auto mesh = solve::uniform_mesh(2);
  constexpr int steps = 10;
  system::RotorSystem s(PETSC_COMM_SELF, train(GetParam()), speed);
  const solve::Cycle c = motion(s, mesh);
  solve::NewtonPicardOptions options;
  options.parameter_scale = speed_scale;
  options.constant_rates = true;
  solve::NewtonPicardProblem picard(s, options, solve::sdirk(2), steps, mesh);
  solve::CycleOptions dense_options;
  dense_options.parameter_scale = speed_scale;
  solve::ShootingProblem dense(PETSC_COMM_SELF, s, dense_options, solve::sdirk(2), steps, mesh);
  core::Vector u = picard.scatter(c), v = dense.scatter(c), row = core::duplicate(u.get()),
               dense_row = core::duplicate(v.get());
  solve::parameter_row(picard, row.get());
  solve::parameter_row(dense, dense_row.get());
  for (const double ratio : {1.0, 1.02, 1.3, 1.6}) {
    SCOPED_TRACE(ratio);
    solve::NewtonOptions newton;
    newton.tolerance = 1e-10;
    newton.max_iterations = 30;
    const double target = ratio * speed / speed_scale;
    ASSERT_TRUE(solve::newton(picard, u.get(), row.get(), target, newton).converged);
    ASSERT_TRUE(solve::newton(dense, v.get(), dense_row.get(), target, newton).converged);
    picard.linearise(u.get(), row.get());
    dense.linearise(v.get(), dense_row.get());
    const auto found = picard.multipliers();
    const auto all = spectral::eigenvalues(dense.monodromy());
    const auto above = [&](const std::vector<std::complex<double>>& mu) {
      return std::count_if(mu.begin(), mu.end(), [&](auto z) { return std::abs(z) > options.radius; });
    };
    EXPECT_EQ(above(found), above(all));
    EXPECT_GT(found.size(), static_cast<std::size_t>(above(found)));
    EXPECT_EQ(picard.subspace(), above(all));
    for (const auto& m : found) {
      double nearest = 1;
      for (const auto& e : all) nearest = std::min(nearest, std::abs(m - e));
      EXPECT_LE(nearest, 1e-6) << m;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Films, StructuredSteps, testing::ValuesIn(cases),
                         [](const auto& p) { return std::string(p.param.name); });
