// Turbulence in films with heat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "whirl/thermal/thd_solver.hpp"

namespace whirl::thermal {
namespace {

Mesh mesh_of(int around, int along, int across, double radius = 0.05, double length = 0.08) {
  Mesh m;
  m.around = around;
  m.along = along;
  m.across = across;
  m.radius = radius;
  m.length = length;
  return m;
}

std::vector<double> thickness(const Rows& rows, double clearance, double eccentricity) {
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < rows.mesh().nodes_around(); ++i)
      h.push_back(clearance * (1 - eccentricity * std::cos(rows.mesh().theta(i))));
  return h;
}

std::vector<double> uniform(const Rows& rows, double temperature) {
  return std::vector<double>(static_cast<std::size_t>(rows.count() * rows.mesh().nodes_around() * rows.mesh().across),
                             temperature);
}

// A thin oil: Re of the clearance 5800.
FilmFlowOptions oil(Turbulence turbulence) {
  FilmFlowOptions o;
  o.fluid.density = 860;
  o.fluid.viscosity = ConstantViscosity{2e-3};
  o.fluid.heat_capacity = 2000;
  o.fluid.conductivity = 0.13;
  o.speed = 1800;
  o.turbulence = turbulence;
  return o;
}

FilmFlowOptions gas(const Mesh& mesh, Turbulence turbulence) {
  FilmFlowOptions o;
  o.fluid.gas = true;
  o.fluid.viscosity = Sutherland{};
  o.fluid.heat_capacity = 1006;
  o.fluid.conductivity = 0.0263;
  o.ambient = 101325;
  o.speed = 1e4;
  o.turbulence = turbulence;
  for (int k = 0; k < 8; ++k) o.orifices.push_back({k * mesh.around / 8, mesh.along / 2, 2e-4, 5e5, 300});
  return o;
}

class BothLaws : public testing::TestWithParam<Turbulence> {};
INSTANTIATE_TEST_SUITE_P(Turbulence, BothLaws, testing::Values(Turbulence::constantinescu, Turbulence::ng_pan));

// Through every face the Couette flow and the pressure's by the law; the shear of a concentric film is mu U/h times the
// Couette factor.
TEST_P(BothLaws, FlowsAndShearAreThoseOfTheLaw) {
  const Rows rows(mesh_of(24, 8, 3), PETSC_COMM_WORLD);
  const Mesh& m = rows.mesh();
  const FilmFlowOptions o = oil(GetParam());
  const double clearance = 145e-6, mu = 2e-3, surface = o.speed * m.radius;
  const std::vector<double> h = thickness(rows, clearance, 0.6);
  FilmFlow film(rows, o, h);
  film.set_temperature(uniform(rows, 313));
  (void)film.solve();
  const Flow flow = film.flow();
  const std::vector<double>& p = film.pressure();
  const auto passes = [&](const Resistance& law, double drag, std::size_t a, std::size_t b, double step) {
    const double middle = 0.5 * (h[a] + h[b]), re = 860 * surface * middle / mu;
    return 860 * (drag * middle / 2 - std::pow(middle, 3) / (evaluate(law, re) * mu) * (p[b] - p[a]) / step);
  };
  const auto sum = [](const double* first) { return first[0] + first[1] + first[2]; };
  const double scale = 860 * surface * clearance;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < 24; ++i) {
      const auto a = static_cast<std::size_t>(rows.node(i, j)),
                 b = static_cast<std::size_t>(rows.node((i + 1) % 24, j));
      EXPECT_NEAR(sum(flow.around.data() + rows.cell(0, i, j)) / m.depth(j),
                  passes(resistance_around(GetParam()), surface, a, b, m.dx()), 1e-11 * scale);
      if (j == rows.begin()) continue;
      const auto before = static_cast<std::size_t>(rows.node(i, j - 1));
      EXPECT_NEAR(sum(flow.along.data() + rows.cell(0, i, j)) / m.width(i),
                  passes(resistance_along(GetParam()), 0, before, a, m.dz()), 1e-11 * scale);
    }
  FilmFlow concentric(rows, o, thickness(rows, clearance, 0));
  concentric.set_temperature(uniform(rows, 313));
  (void)concentric.solve();
  const double area = 2 * std::numbers::pi * m.radius * m.length, re = 860 * surface * clearance / mu;
  EXPECT_NEAR(concentric.report(concentric.flow()).friction /
                  (mu * surface / clearance * area * m.radius * couette_factor(GetParam(), re)),
              1, 1e-12);
}

// Without motion, and with a Reynolds number that falls to nothing, a film is laminar.
TEST_P(BothLaws, SlowFilmsAreLaminar) {
  const Rows rows(mesh_of(24, 8, 3), PETSC_COMM_WORLD);
  double off[2] = {};
  for (const int k : {0, 1}) {
    FilmFlowOptions o = oil(GetParam());
    o.speed = k == 0 ? 1e-2 : 1e-4;
    double friction[2] = {};
    for (const bool turbulent : {false, true}) {
      o.turbulence = turbulent ? GetParam() : Turbulence::laminar;
      FilmFlow film(rows, o, thickness(rows, 145e-6, 0.6));
      film.set_temperature(uniform(rows, 313));
      (void)film.solve();
      friction[turbulent ? 1 : 0] = film.report(film.flow()).friction;
    }
    off[k] = friction[1] / friction[0] - 1;
  }
  EXPECT_GT(off[0], 0);
  EXPECT_LT(off[0], 1e-3);
  EXPECT_LT(off[1], 0.02 * off[0]);  // 100^-0.94
}

// What heats is what the shaft loses, of a liquid less what the pressure takes; no layer is cooled by its own motion.
TEST_P(BothLaws, HeatIsWhatTheShaftLoses) {
  const Rows rows(mesh_of(32, 8, 5), PETSC_COMM_WORLD);
  FilmFlowOptions o = oil(GetParam());
  o.fluid.viscosity = Vogel{2e-3, 313.15, 800, 150};
  FilmFlow film(rows, o, thickness(rows, 145e-6, 0.6));
  std::vector<double> t = uniform(rows, 313);
  for (std::size_t k = 0; k < t.size(); ++k) t[k] += 5 * static_cast<double>(k % 5);
  film.set_temperature(t);
  (void)film.solve();
  const Flow flow = film.flow();
  const FlowReport r = film.report(flow);
  EXPECT_NEAR(r.heat + r.expansion, r.power, 1e-11 * r.power);
  EXPECT_LT(r.defect, 1e-12 * 860 * 90 * 145e-6 * 0.08);
  EXPECT_GT(*std::ranges::min_element(flow.heat), 0);
  EXPECT_GE(*std::ranges::min_element(flow.mixing), 1);

  const Rows small(mesh_of(32, 8, 4, 0.015, 0.03), PETSC_COMM_WORLD);
  FilmFlow air(small, gas(small.mesh(), GetParam()), thickness(small, 2e-5, 0.5));
  air.set_temperature(uniform(small, 300));
  (void)air.solve();
  const FlowReport g = air.report(air.flow());
  EXPECT_NEAR(g.heat, g.power, 1e-11 * g.power);
  EXPECT_NEAR(g.inflow, g.outflow, 1e-10 * g.inflow);
  EXPECT_LT(g.defect, 1e-12 * g.inflow);
}

// The density of a gas, and with it the resistance, knows the pressure, in the film and at the rims of orifices.
TEST_P(BothLaws, DerivativesOfAGasAreExact) {
  const Rows rows(mesh_of(16, 8, 3, 0.015, 0.03), PETSC_COMM_WORLD);
  FilmFlow film(rows, gas(rows.mesh(), GetParam()), thickness(rows, 2e-5, 0.6));
  std::vector<double> t = uniform(rows, 300);
  for (std::size_t k = 0; k < t.size(); ++k) t[k] += 20 * std::sin(static_cast<double>(k));
  film.set_temperature(t);
  (void)film.solve();
  core::Vector x = core::duplicate(film.state()), d = core::duplicate(x.get()), y = core::duplicate(x.get()),
               g = core::duplicate(x.get());
  core::check(VecCopy(film.state(), x.get()));
  core::check(VecScale(x.get(), 1.1));
  {
    PetscInt first = 0;
    core::check(VecGetOwnershipRange(d.get(), &first, nullptr));
    const core::WriteArray a(d.get());
    for (PetscInt i = 0; i < a.size(); ++i) a[i] = 1e5 * std::sin(1.3 * static_cast<double>(first + i));
  }
  film.jacobian(x.get(), film.matrix());
  core::check(MatMult(film.matrix(), d.get(), y.get()));
  // Central differences: the error falls with the square of the step.
  double errors[2] = {};
  for (const int k : {0, 1}) {
    const double step = k == 0 ? 0.1 : 0.01;
    core::Vector high = core::duplicate(x.get()), low = core::duplicate(x.get());
    core::check(VecWAXPY(g.get(), step, d.get(), x.get()));
    film.residual(g.get(), high.get());
    core::check(VecWAXPY(g.get(), -step, d.get(), x.get()));
    film.residual(g.get(), low.get());
    core::check(VecAXPY(high.get(), -1, low.get()));
    core::check(VecScale(high.get(), 0.5 / step));
    core::check(VecAXPY(high.get(), -1, y.get()));
    errors[k] = core::norm(high.get()) / core::norm(y.get());
  }
  EXPECT_LT(errors[1], 1e-6);
  EXPECT_NEAR(std::log10(errors[0] / errors[1]), 2, 0.1);
}

// Film, bush and journal together: balances hold, and the eddies leave less difference of temperature across.
TEST_P(BothLaws, BalanceOfABearingCloses) {
  const Rows rows(mesh_of(32, 8, 6), PETSC_COMM_WORLD);
  ThdSetup setup;
  setup.flow = oil(GetParam());
  setup.flow.fluid.viscosity = Vogel{2e-3, 313.15, 800, 150};
  setup.flow.cavitation = FilmFlowOptions::Cavitation::reynolds;
  setup.flow.feeds.push_back({-2, 2, 1, 7, 1e6});
  setup.ambient = 313.15;
  setup.bush.type = WallOptions::Type::solid;
  setup.bush.conductivity = 50;
  setup.bush.radius = 0.1;
  setup.bush.convection = 80;
  setup.bush.ambient = 313.15;
  setup.journal.type = WallOptions::Type::isothermal;
  setup.journal.temperature = 313.15;
  ThdSolver thd(rows, setup, thickness(rows, 145e-6, 0.5));
  EXPECT_TRUE(thd.solve().converged);
  const FlowReport r = thd.flow().report(thd.flows());
  EXPECT_NEAR(r.heat + r.expansion, r.power, 1e-10 * r.power);
  EXPECT_LT(std::abs(thd.budget().residual()), 1e-8 * r.power);
  EXPECT_GE(*std::ranges::min_element(thd.temperature()), 313.15 - 1e-6);
}

// Reichardt's eddies give a Couette flow about the shear that the factor says: heat with Pr = Pr_t is that shear.
TEST(Eddies, GiveTheShearOfACouetteFlow) {
  for (const double re : {2000.0, 5000.0, 10000.0, 20000.0}) {
    const double factor = couette_factor(Turbulence::ng_pan, re);
    EXPECT_NEAR(eddy_conduction(0.5 * std::sqrt(factor * re), turbulent_prandtl, 0, 1), factor, 0.15 * factor) << re;
  }
}

// Segments stand in series; both halves are alike; without eddies, or heat that they would carry, nothing is better.
TEST(Eddies, ResistancesAddUp) {
  for (const double half : {5.0, 100.0, 2000.0})
    for (const double prandtl : {0.7, 30.0}) {
      double sum = 0;
      for (int k = 0; k <= 7; ++k) {
        const double from = k == 0 ? 0 : (k - 0.5) / 7, to = k == 7 ? 1 : (k + 0.5) / 7;
        sum += (to - from) / eddy_conduction(half, prandtl, from, to);
        EXPECT_NEAR(eddy_conduction(half, prandtl, 1 - to, 1 - from) / eddy_conduction(half, prandtl, from, to), 1,
                    1e-12);
      }
      EXPECT_NEAR(sum * eddy_conduction(half, prandtl, 0, 1), 1, 2e-3) << half << " " << prandtl;
    }
  EXPECT_EQ(eddy_conduction(0, 7, 0, 0.5), 1);
  EXPECT_NEAR(eddy_conduction(100, 0, 0.1, 0.3), 1, 1e-5);
  // Close to a wall the law falls with the third power of the distance, across the change of its form.
  EXPECT_NEAR(eddy_viscosity(0.1069) / eddy_viscosity(0.1071), std::pow(0.1069 / 0.1071, 3), 1e-6);
}

}  // namespace
}  // namespace whirl::thermal
