// What a film with heat has at each node: heat flows, work of pressure, where it is ruptured.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "whirl/thermal/thd_solver.hpp"

namespace whirl::thermal {
namespace {

std::size_t at(PetscInt k) {
  return static_cast<std::size_t>(k);
}

Mesh mesh_of(int around, int along, int across) {
  Mesh mesh;
  mesh.around = around;
  mesh.along = along;
  mesh.across = across;
  mesh.radius = 0.015;
  mesh.length = 0.03;
  return mesh;
}

std::vector<double> thickness_of(const Rows& rows, double eccentricity) {
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < rows.mesh().nodes_around(); ++i)
      h.push_back(2e-5 * (1 - eccentricity * std::cos(rows.mesh().theta(i))));
  return h;
}

ThdSetup setup_of(bool gas) {
  ThdSetup s;
  s.flow.fluid.gas = gas;
  s.flow.fluid.density = 860;
  s.flow.fluid.heat_capacity = gas ? 1006 : 2000;
  s.flow.fluid.conductivity = gas ? 0.0263 : 0.13;
  s.flow.fluid.viscosity = gas ? Viscosity(Sutherland{}) : Viscosity(ConstantViscosity{0.02});
  s.flow.ambient = gas ? 101325 : 0;
  s.flow.speed = 1000;
  return s;
}

double sum(const Rows& rows, const std::vector<double>& values) {
  double all = std::accumulate(values.begin(), values.end(), 0.0);
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_DOUBLE, MPI_SUM, rows.comm());
  return all;
}

// W [r, n]
std::vector<double> dissipation_of(const Rows& rows, const ThdSolver& thd) {
  std::vector<double> out = thd.flow().expansion(thd.flows());
  const auto l = at(rows.mesh().across);
  for (std::size_t c = 0; c < out.size(); ++c) {
    out[c] = -out[c];
    for (std::size_t k = 0; k < l; ++k) out[c] += thd.flows().heat[c * l + k];
  }
  return out;
}

// Between walls of one temperature each takes half of mu U^2/h; all of it where the other takes none.
TEST(FilmMaps, CouetteFlowHeatsBothWallsAlike) {
  for (const bool alone : {false, true}) {
    const Rows rows(mesh_of(24, 6, 5), PETSC_COMM_WORLD);
    ThdSetup setup = setup_of(false);
    setup.ambient = setup.bush.temperature = setup.journal.temperature = 320;
    if (alone) setup.journal.type = WallOptions::Type::adiabatic;
    ThdSolver thd(rows, setup, thickness_of(rows, 0));
    EXPECT_TRUE(thd.solve().converged);
    const double whole = 0.02 * 15 * 15 / 2e-5;  // W/m^2
    const std::vector<double> bush = thd.wall_heat(false), journal = thd.wall_heat(true),
                              dissipation = dissipation_of(rows, thd);
    for (int j = rows.begin(); j < rows.end(); ++j)
      for (int i = 0; i < 24; ++i) {
        const double area = rows.mesh().width(i) * rows.mesh().depth(j);
        const auto c = at(rows.node(i, j));
        EXPECT_NEAR(bush[c] / area, (alone ? 1 : 0.5) * whole, 1e-9 * whole);
        EXPECT_NEAR(journal[c] / area, (alone ? 0 : 0.5) * whole, 1e-9 * whole);
        EXPECT_NEAR(dissipation[c] / area, whole, 1e-9 * whole);
      }
  }
}

TEST(FilmMaps, AddUpToTheBudget) {
  const Rows rows(mesh_of(48, 16, 6), PETSC_COMM_WORLD);
  ThdSetup setup = setup_of(true);
  setup.flow.speed = 1e4;
  for (int k = 0; k < 8; ++k) setup.flow.orifices.push_back({k * 6, 8, 2e-4, 5e5, 300});
  setup.flow.fluid.conductivity_law = PowerLaw{273.15, 0.9};
  setup.bush.type = WallOptions::Type::solid;
  setup.bush.conductivity = 45;
  setup.bush.radius = 0.025;
  setup.bush.convection = 50;
  ThdSolver thd(rows, setup, thickness_of(rows, 0.5));
  EXPECT_TRUE(thd.solve().converged);
  const EnergyBudget budget = thd.budget();
  const FlowReport report = thd.flow().report(thd.flows());
  EXPECT_NEAR(sum(rows, thd.wall_heat(false)), budget.bush, 1e-12 * budget.heat);
  EXPECT_NEAR(sum(rows, thd.wall_heat(true)), budget.journal, 1e-12 * budget.heat);
  const std::vector<double> dissipation = dissipation_of(rows, thd);
  EXPECT_NEAR(sum(rows, dissipation), report.heat - report.expansion, 1e-12 * report.heat);
  EXPECT_LT(report.expansion, -5);
  // Friction only heats, at every node.
  EXPECT_GT(*std::min_element(dissipation.begin(), dissipation.end()), 0);
}

TEST(FilmMaps, CavitiesAreThoseOfThePressure) {
  using Cavitation = FilmFlowOptions::Cavitation;
  const Rows rows(mesh_of(48, 8, 2), PETSC_COMM_WORLD);
  const int n = 48, last = rows.mesh().along;
  for (const Cavitation law : {Cavitation::reynolds, Cavitation::mass_conserving, Cavitation::none}) {
    FilmFlowOptions options = setup_of(false).flow;
    options.cavitation = law;
    // Without pressure of its own, but full.
    options.feeds.push_back({26, 30, 2, 6, law == Cavitation::mass_conserving ? 1e3 : 0});
    FilmFlow film(rows, options, thickness_of(rows, 0.6));
    film.set_temperature(std::vector<double>(at(rows.count() * n * 2), 300));
    (void)film.solve();
    const std::vector<char> ruptured = film.ruptured();
    long cells = 0;
    for (int j = rows.begin(); j < rows.end(); ++j)
      for (int i = 0; i < n; ++i) {
        const auto c = at(rows.node(i, j));
        const bool fed = i >= 26 && i <= 30 && j >= 2 && j <= 6;
        const int inside = std::clamp(j, 1, last - 1);  // an end is as its neighbour
        const bool empty = law != Cavitation::none && !fed && film.pressure()[at(rows.node(i, inside))] <= 0;
        EXPECT_EQ(ruptured[c] != 0, empty) << i << " " << j;
        cells += ruptured[c];
      }
    MPI_Allreduce(MPI_IN_PLACE, &cells, 1, MPI_LONG, MPI_SUM, rows.comm());
    EXPECT_EQ(cells > 0, law != Cavitation::none);
    EXPECT_EQ(film.conserves_mass(), law == Cavitation::mass_conserving);
  }
}

}  // namespace
}  // namespace whirl::thermal
