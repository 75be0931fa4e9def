// A film that starts from its solution on coarser meshes.
#include "thermal/thd_coarse.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "whirl/core/index.hpp"

namespace whirl::thermal {
namespace {

using core::at;

Mesh bore(int around, int along, int across) {
  Mesh mesh;
  mesh.around = around;
  mesh.along = along;
  mesh.across = across;
  mesh.radius = 0.015;
  mesh.length = 0.03;
  return mesh;
}

ThdSetup gas_film() {
  ThdSetup s;
  s.flow.fluid.gas = true;
  s.flow.fluid.viscosity = Sutherland{};
  s.flow.fluid.heat_capacity = 1006;
  s.flow.fluid.conductivity = 0.0263;
  s.flow.ambient = 101325;
  s.flow.speed = 1e4;
  for (int k = 0; k < 4; ++k) s.flow.orifices.push_back({k * 8 + 1, 8, 2e-4, 5e5, 300});
  s.bush.type = s.journal.type = WallOptions::Type::solid;
  s.bush.conductivity = 45;
  s.bush.radius = 0.025;
  s.bush.convection = 50;
  s.journal.conductivity = 16;
  s.journal.radius = 0.005;
  s.journal.convection = 200;
  s.journal.shaft_length = 0.05;
  s.journal.shaft_before = 0.01;
  return s;
}

// Bilinear interpolation keeps what is linear along and, between two nodes, around; state also across.
TEST(ThdCoarse, InterpolatesWhatIsLinearExactly) {
  const Rows coarse(bore(16, 8, 4), PETSC_COMM_WORLD), fine(bore(32, 17, 8), PETSC_COMM_WORLD);
  const auto along = [](const Rows& rows, int j) { return static_cast<double>(j) / rows.mesh().along; };
  std::vector<double> state;
  for (int j = coarse.begin(); j < coarse.end(); ++j)
    for (int i = 0; i < 16; ++i) {
      for (int k = 0; k < 4; ++k) state.push_back(300 + 5 * along(coarse, j) + (k + 0.5) / 4);
      for (int k = 0; k < 5; ++k) state.push_back(k + std::abs(i - 8) + along(coarse, j));
    }
  const std::vector<double> got = interpolate_state(coarse, fine, state);
  ASSERT_EQ(got.size(), at(fine.count()) * 32 * 13);
  for (int j = fine.begin(); j < fine.end(); ++j)
    for (int i = 0; i < 32; ++i) {
      const double* column = &got[at(fine.node(i, j)) * 13];
      for (int k = 1; k < 7; ++k) EXPECT_NEAR(column[k], 300 + 5 * along(fine, j) + (k + 0.5) / 8, 1e-12);
      for (int k = 0; k < 5; ++k) EXPECT_NEAR(column[8 + k], k + std::abs(i / 2.0 - 8) + along(fine, j), 1e-12);
    }
}

TEST(ThdCoarse, HasNoMeshWhereOrificesWouldMeet) {
  FilmFlowOptions flow;
  flow.orifices = {{3, 8, 1e-4, 5e5, 300}, {4, 8, 1e-4, 5e5, 300}};
  EXPECT_FALSE(coarser(bore(32, 16, 8), flow, 1));
  flow.orifices[1].i = 8;
  EXPECT_TRUE(coarser(bore(32, 16, 8), flow, 1));
}

// Where the film starts from does not matter to what is found, and the balances hold to rounding.
TEST(ThdCoarse, StartsFindTheSame) {
  const Rows rows(bore(32, 16, 6), PETSC_COMM_WORLD);
  std::vector<double> h, found[2];
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < 32; ++i) h.push_back(2e-5 * (1 - 0.5 * std::cos(rows.mesh().theta(i))));
  for (const int start : {0, 100}) {
    ThdSetup setup = gas_film();
    setup.coarse_start = start;
    ThdSolver thd(rows, setup, h);
    EXPECT_TRUE(thd.solve().converged);
    const EnergyBudget budget = thd.budget();
    EXPECT_LT(std::abs(budget.residual()), 1e-9 * budget.heat);
    found[start > 0] = thd.temperature();
  }
  double most = 0;
  for (std::size_t c = 0; c < found[0].size(); ++c) {
    EXPECT_NEAR(found[0][c], found[1][c], 3e-5);
    most = std::max(most, found[0][c] - 300);
  }
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  EXPECT_GT(most, 5) << "the film is warm";
}

}  // namespace
}  // namespace whirl::thermal
