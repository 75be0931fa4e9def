// Oil that a groove mixes.
#include <gtest/gtest.h>

#include <random>

#include "support/heated_film.hpp"
#include "whirl/thermal/energy.hpp"

namespace whirl::thermal {
namespace {

using test::HeatedFilm;

constexpr double capacity = 2000, fresh = 313, ambient = 300;

// Layers of Couette flow of different temperature pass a groove over the whole width, which adds oil to the layer at
// the bush. Nothing conducts, nothing heats: behind it, and in it, all has the temperature
// (sum m_k T_k + m T)/(sum m_k + m).
TEST(GrooveMixing, LayersLeaveWithTheMeanByMass) {
  Mesh mesh;
  mesh.around = 12;
  mesh.along = 6;
  mesh.across = 4;
  mesh.closed = false;
  mesh.radius = 1;
  mesh.extent = 1;
  mesh.length = 0.5;
  const double h = 1e-4, added = 0.02;  // kg/(m s)
  const int first = 4, last = 7;
  HeatedFilm film(
      mesh, PETSC_COMM_WORLD, [=](double, double) { return h; },
      [&](double x, double z0, double z1, double a, double b) {
        return (400 * h * (b * b - a * a) + (a < 0.1 && x > (first * mesh.extent / 12) ? added : 0)) * (z1 - z0);
      },
      [](double, double, double, double, double) { return 0.0; });
  std::fill(film.flow.across.begin(), film.flow.across.end(), 0.0);
  Surroundings s{film.adiabatic(), film.adiabatic(), ambient, {}, {}};
  s.supply.assign(film.thickness.size(), fresh);
  s.mixed.assign(film.thickness.size(), 0);
  for (int j = film.rows.begin(); j < film.rows.end(); ++j) {
    film.flow.inflow[film.cell(0, first, j)] = added * mesh.depth(j);
    for (int i = first; i <= last; ++i) s.mixed[film.node(i, j)] = 1;
    for (int k = 0; k < mesh.across; ++k) s.entering.push_back(320 + 10 * film.middle(k));
  }
  double heat = added * fresh, mass = added;
  for (int k = 0; k < mesh.across; ++k) {
    const double m = 400 * h * (film.zeta(k + 1) * film.zeta(k + 1) - film.zeta(k) * film.zeta(k));
    heat += m * (320 + 10 * film.middle(k));
    mass += m;
  }
  for (const int order : {1, 2}) {
    Energy energy(film.rows, film.flow, {capacity, 1e-9, order}, film.thickness, s);
    core::Vector t = film.temperature(ambient);
    const EnergySolve solved = energy.solve(t.get(), 1e-12);
    ASSERT_TRUE(solved.converged);
    EXPECT_LT(solved.krylov, 60);
    const core::ReadArray found(t.get());
    film.each([&](int k, int i, int j) {
      const double value = found[film.rows.cell(k, i, j)];
      EXPECT_NEAR(value, i < first ? 320 + 10 * film.middle(k) : heat / mass,
                  i == first  ? 0.2
                  : i <= last ? 2e-3
                              : 1e-5);
    });
    EXPECT_NEAR(energy.mixed(t.get()).at(0), heat / mass, 0.02);
    const EnergyBudget b = energy.budget(t.get());
    EXPECT_NEAR(b.residual(), 0, 1e-8 * std::abs(b.ends));
  }
}

// A bearing's film with a groove that mixes: the balance holds, the cells of the groove have one temperature, and the
// derivative is that of the residual.
TEST(GrooveMixing, BearingKeepsItsBalance) {
  const auto film = test::heated_bearing(PETSC_COMM_WORLD, 32, 8, 6, 0.5);
  Surroundings s{film->adiabatic(), film->adiabatic(), ambient, {}, {}};
  s.mixed.assign(film->thickness.size(), 0);
  for (int j = std::max(1, film->rows.begin()); j < std::min(8, film->rows.end()); ++j)
    for (const int i : {30, 31, 0, 1, 2}) s.mixed[film->node(i, j)] = 1;
  const std::vector<int> groove = s.mixed;
  for (const bool mixes : {false, true}) {
    s.mixed = mixes ? groove : std::vector<int>{};
    Energy energy(film->rows, film->flow, {capacity, 0.13, 2}, film->thickness, s);
    core::Vector t = film->temperature(ambient);
    ASSERT_TRUE(energy.solve(t.get(), 1e-12).converged);
    const EnergyBudget b = energy.budget(t.get());
    EXPECT_NEAR(b.residual(), 0, 1e-9 * b.heat);
    const core::ReadArray found(t.get());
    double ends[2] = {-1e9, -1e9};
    film->each([&](int k, int i, int j) {
      if (groove[film->node(i, j)] == 0) return;
      const double value = found[film->rows.cell(k, i, j)];
      ends[0] = std::max(ends[0], value);
      ends[1] = std::max(ends[1], -value);
    });
    MPI_Allreduce(MPI_IN_PLACE, ends, 2, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
    if (mixes) {
      EXPECT_LT(ends[0] + ends[1], 0.1);
      EXPECT_NEAR(energy.mixed(t.get()).at(0), 0.5 * (ends[0] - ends[1]), 0.05);
    } else {
      EXPECT_GT(ends[0] + ends[1], 1);
      EXPECT_TRUE(energy.mixed(t.get()).empty());
    }
  }
}

TEST(GrooveMixing, DerivativeIsThatOfTheResidual) {
  const auto film = test::heated_bearing(PETSC_COMM_WORLD, 16, 6, 4, 0.4);
  Surroundings s{film->isothermal(0.13, 310), film->adiabatic(), ambient, {}, {}};
  s.mixed.assign(film->thickness.size(), 0);
  for (int j = film->rows.begin(); j < film->rows.end(); ++j)
    for (int i = 0; i < 3; ++i) s.mixed[film->node(i, j)] = j < 3 ? 1 : 2;
  Energy energy(film->rows, film->flow, {capacity, 0.13, 2}, film->thickness, s);
  core::Vector t = film->temperature(ambient), v = film->temperature(0), by_product = film->temperature(0);
  film->each([&](int k, int i, int j) {
    const PetscInt cell = film->rows.cell(k, i, j);
    const core::WriteArray at(t.get()), to(v.get());
    at[cell] = 320 + 7 * std::sin(1.0 * i + 0.7 * j) + k;
    to[cell] = std::cos(2.0 * i - 0.3 * j + k);
  });
  energy.linearise(t.get());
  core::check(MatMult(energy.jacobian(), v.get(), by_product.get()));
  double before = 0;
  for (const double step : {1e-2, 5e-3}) {
    core::Vector moved = film->temperature(0), up = film->temperature(0), down = film->temperature(0);
    core::check(VecWAXPY(moved.get(), step, v.get(), t.get()));
    energy.residual(moved.get(), up.get());
    core::check(VecWAXPY(moved.get(), -step, v.get(), t.get()));
    energy.residual(moved.get(), down.get());
    core::check(VecAXPY(up.get(), -1, down.get()));
    core::check(VecAXPBY(up.get(), -1, 1 / (2 * step), by_product.get()));
    const double off = core::norm(up.get()) / core::norm(by_product.get());
    EXPECT_LT(off, 1e-6);
    if (before > 0) {
      EXPECT_LT(off, std::max(0.3 * before, 1e-8));
    }
    before = off;
  }
}

}  // namespace
}  // namespace whirl::thermal
