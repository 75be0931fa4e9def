// Bearing A of Skarolek (2011) with heat, against an independent computation (reference 003).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "whirl/thermal/thd_solver.hpp"

namespace whirl::thermal {
namespace {

struct Numbers {
  double mean = 0, bush = 0, journal = 0, power = 0, residual = 0, heat = 0, change = 0;
  ThdSolve cost;
};

ThdSetup setup_of_a(const Rows& rows, double speed) {
  const Mesh& mesh = rows.mesh();
  ThdSetup s;
  s.flow.fluid.gas = true;
  s.flow.fluid.viscosity = Sutherland{};
  s.flow.fluid.heat_capacity = 1006;
  s.flow.fluid.conductivity = 0.0263;
  s.flow.ambient = 101325;
  s.flow.speed = speed;
  for (int k = 0; k < 8; ++k) s.flow.orifices.push_back({k * mesh.around / 8, mesh.along / 2, 2e-4, 5e5, 300});
  return s;
}

Numbers solve(int around, int along, int across, double speed, void (*change)(ThdSetup&) = nullptr) {
  Mesh mesh;
  mesh.around = around;
  mesh.along = along;
  mesh.across = across;
  mesh.radius = 0.015;
  mesh.length = 0.03;
  const Rows rows(mesh, PETSC_COMM_WORLD);
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < around; ++i) h.push_back(2e-5 * (1 - 0.5 * std::cos(mesh.theta(i))));
  ThdSetup setup = setup_of_a(rows, speed);
  if (change) change(setup);
  ThdSolver thd(rows, setup, h);
  Numbers out;
  out.cost = thd.solve();
  double sums[2] = {};
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < around; ++i)
      for (int k = 0; k < across; ++k) {
        const double volume = h[static_cast<std::size_t>(rows.node(i, j))] * mesh.depth(j);
        sums[0] += volume * thd.temperature()[static_cast<std::size_t>(rows.cell(k, i, j))];
        sums[1] += volume;
      }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  out.mean = sums[0] / sums[1];
  const EnergyBudget budget = thd.budget();
  out.bush = budget.bush;
  out.journal = budget.journal;
  out.heat = budget.heat;
  out.residual = budget.residual();
  out.power = thd.flow().report(thd.flows()).power;
  return out;
}

TEST(Thd, BearingAtTenThousandRadiansPerSecond) {
  const Numbers n = solve(96, 32, 8, 1e4);
  EXPECT_TRUE(n.cost.converged);
  EXPECT_NEAR(n.mean, 301.23, 0.08);
  EXPECT_NEAR(n.bush, 33.94, 0.1);
  EXPECT_NEAR(n.journal, 35.68, 0.1);
  EXPECT_NEAR(n.power, 69.74, 0.1);
  EXPECT_NEAR(n.heat, n.power, 1e-9 * n.power);
  EXPECT_LT(std::abs(n.residual), 1e-8 * n.power);
  EXPECT_LE(n.cost.iterations, 10);
}

TEST(Thd, SolidsCarryTheHeatAway) {
  const Numbers n = solve(48, 16, 8, 1e4, [](ThdSetup& s) {
    s.bush.type = s.journal.type = WallOptions::Type::solid;
    s.bush.conductivity = 45;
    s.bush.radius = 0.025;
    s.bush.convection = 50;
    s.journal.conductivity = 16;
    s.journal.radius = 0.005;
    s.journal.convection = 200;
    s.journal.shaft_length = 0.1;
    s.journal.shaft_before = 0.02;
    s.inlet_from_bush = true;
  });
  EXPECT_TRUE(n.cost.converged);
  EXPECT_NEAR(n.mean - 300, 67.4, 0.67);
  EXPECT_LT(std::abs(n.residual), 1e-8 * n.power);
}

}  // namespace
}  // namespace whirl::thermal
