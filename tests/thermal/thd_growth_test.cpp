// Bush and journal whose growth changes the thickness of the film between them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "whirl/thermal/thd_solver.hpp"

namespace whirl::thermal {
namespace {

constexpr double radius = 0.015, clearance = 2e-5;

Mesh mesh_of(int around, int along, int across) {
  Mesh mesh;
  mesh.around = around;
  mesh.along = along;
  mesh.across = across;
  mesh.radius = radius;
  mesh.length = 0.03;
  return mesh;
}

std::vector<double> thickness_of(const Rows& rows) {
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < rows.mesh().nodes_around(); ++i)
      h.push_back(clearance * (1 - 0.5 * std::cos(rows.mesh().theta(i))));
  return h;
}

// A gas film that carries by its rotation alone, between bush and shaft that grow.
ThdSetup setup_of(double speed, double ambient) {
  ThdSetup s;
  s.flow.fluid.gas = true;
  s.flow.fluid.viscosity = Sutherland{};
  s.flow.fluid.heat_capacity = 1006;
  s.flow.fluid.conductivity = 0.0263;
  s.flow.ambient = 101325;
  s.flow.speed = speed;
  s.ambient = ambient;
  s.bush.type = s.journal.type = WallOptions::Type::solid;
  s.bush.conductivity = 45;
  s.bush.radius = 0.025;
  s.bush.convection = 50;
  s.journal.conductivity = 16;
  s.journal.radius = 0.005;
  s.journal.convection = 200;
  s.journal.shaft_length = 0.05;
  s.journal.shaft_before = 0.01;
  s.bush.ambient = s.journal.ambient = ambient;
  s.bush.growth = s.journal.growth = true;
  s.bush.expansion = 1.2e-5;
  s.journal.expansion = 0.7e-5;
  s.bush.reference = s.journal.reference = 300;
  return s;
}

// Everything 40 K warmer than where the clearance is measured: it has grown by alpha R 40 K of the bush less the same
// of the journal, everywhere alike.
TEST(ThdGrowth, OfAUniformRiseIsExact) {
  const Rows rows(mesh_of(16, 8, 4), PETSC_COMM_WORLD);
  const std::vector<double> cold = thickness_of(rows);
  ThdSolver thd(rows, setup_of(0, 340), cold);
  EXPECT_TRUE(thd.solve().converged);
  const double grown = (1.2e-5 - 0.7e-5) * radius * 40;
  for (std::size_t c = 0; c < cold.size(); ++c) EXPECT_NEAR(thd.thickness()[c] - cold[c], grown, 1e-9 * grown);
}

// What the film is thicker by is what the solids have grown at the temperatures that came out.
TEST(ThdGrowth, IsThatOfTheSolids) {
  const Rows rows(mesh_of(24, 12, 4), PETSC_COMM_WORLD);
  const std::vector<double> cold = thickness_of(rows);
  ThdSolver thd(rows, setup_of(1e4, 300), cold);
  EXPECT_TRUE(thd.solve().converged);
  const std::vector<double> bush = thd.solid(false)->growth(thd.solid_temperature(false), 300),
                            journal = thd.solid(true)->growth(thd.solid_temperature(true), 300);
  double most = 0;
  for (std::size_t c = 0; c < cold.size(); ++c) {
    const std::size_t row = c / 24;
    EXPECT_NEAR(thd.thickness()[c] - cold[c], bush[row] - journal[row], 1e-7 * clearance);
    most = std::max(most, bush[row] - journal[row]);
  }
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  EXPECT_GT(most, 0.01 * clearance) << "there is something to be seen";
  EXPECT_LT(std::abs(thd.budget().residual()), 1e-8 * thd.budget().heat);
}

// The mean thickness over the mesh, of second order.
TEST(ThdGrowth, ConvergesWithTheMesh) {
  std::vector<double> means;
  for (const int m : {1, 2, 4}) {
    const Rows rows(mesh_of(12 * m, 6 * m, 3 * m), PETSC_COMM_WORLD);
    ThdSetup setup = setup_of(1e4, 300);
    setup.bush.layers = setup.journal.layers = 3 * m;
    ThdSolver thd(rows, setup, thickness_of(rows));
    EXPECT_TRUE(thd.solve().converged);
    double sums[2] = {};
    for (int j = rows.begin(); j < rows.end(); ++j)
      for (int i = 0; i < rows.mesh().around; ++i) {
        sums[0] += thd.thickness()[static_cast<std::size_t>(rows.node(i, j))] * rows.mesh().depth(j);
        sums[1] += rows.mesh().depth(j);
      }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    means.push_back(sums[0] / sums[1]);
  }
  const double order = std::log2(std::abs((means[1] - means[0]) / (means[2] - means[1])));
  RecordProperty("order", std::to_string(order));
  EXPECT_GT(order, 1.5);
  EXPECT_LT(order, 3);
}

// A shaft that grows so much more than its bush that it would touch is no film any more.
TEST(ThdGrowth, SaysWhereTheFilmCloses) {
  const Rows rows(mesh_of(16, 8, 4), PETSC_COMM_WORLD);
  ThdSetup setup = setup_of(0, 400);
  setup.bush.expansion = 1e-6;
  setup.journal.expansion = 2e-5;
  ThdSolver thd(rows, setup, thickness_of(rows));
  EXPECT_THROW((void)thd.solve(), core::NotConverged);
}

// Another film goes on from where one has come to.
TEST(ThdGrowth, GoesOnFromAState) {
  const Rows rows(mesh_of(24, 12, 4), PETSC_COMM_WORLD);
  ThdSolver one(rows, setup_of(1e4, 300), thickness_of(rows)), other(rows, setup_of(1e4, 300), thickness_of(rows));
  const ThdSolve first = one.solve();
  other.start(one.state());
  const ThdSolve again = other.solve();
  EXPECT_TRUE(again.converged);
  EXPECT_LE(again.iterations, 2);
  EXPECT_GT(first.iterations, 5);
  for (std::size_t c = 0; c < one.temperature().size(); ++c)
    EXPECT_NEAR(one.temperature()[c], other.temperature()[c], 1e-5);
}

}  // namespace
}  // namespace whirl::thermal
