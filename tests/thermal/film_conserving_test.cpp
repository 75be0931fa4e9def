// Films with heat that conserve the mass of their cavity.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "whirl/core/error.hpp"
#include "whirl/thermal/thd_solver.hpp"

namespace whirl::thermal {
namespace {

using std::numbers::pi;

constexpr double kClearance = 145e-6;

// The bearing of Ferron, Frene and Boncompain (1983) with a groove at its widest gap, theta = pi.
Mesh mesh_of(int around, int along, int across) {
  Mesh m;
  m.around = around;
  m.along = along;
  m.across = across;
  m.radius = 0.05;
  m.length = 0.08;
  return m;
}

std::vector<double> thickness(const Rows& rows, double eccentricity) {
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < rows.mesh().nodes_around(); ++i)
      h.push_back(kClearance * (1 - eccentricity * std::cos(rows.mesh().theta(i))));
  return h;
}

std::vector<double> uniform(const Rows& rows, double temperature) {
  return std::vector<double>(static_cast<std::size_t>(rows.count() * rows.mesh().nodes_around() * rows.mesh().across),
                             temperature);
}

FilmFlowOptions oil(const Mesh& mesh, double pressure, int half_width) {
  FilmFlowOptions o;
  o.fluid.density = 860;
  o.fluid.viscosity = ConstantViscosity{0.0277};
  o.fluid.heat_capacity = 2000;
  o.fluid.conductivity = 0.13;
  o.speed = 300;
  o.cavitation = FilmFlowOptions::Cavitation::mass_conserving;
  const int middle = mesh.around / 2;
  o.feeds.push_back({middle - half_width, middle + half_width, 1, mesh.along - 1, pressure});
  return o;
}

// int from 0 to b of (h - h(b))/h^3, h = 1 + e cos t, by Simpson's rule: nothing at the rupture of a long film that
// begins without pressure at its widest gap (docs/mass_conserving.md, closed forms at rest).
double pressure_at(double b, double to, double e) {
  constexpr int steps = 2000;
  const double border = 1 + e * std::cos(b);
  double sum = 0;
  for (int k = 0; k <= steps; ++k) {
    const double h = 1 + e * std::cos(to * k / steps);
    sum += (k == 0 || k == steps ? 1 : (k % 2 == 1 ? 4 : 2)) * (h - border) / (h * h * h);
  }
  return sum * to / steps / 3;
}

TEST(FilmConserving, LongFilmHasItsClosedForm) {
  const double e = 0.5;
  double low = pi, high = 2 * pi;
  while (high - low > 1e-12) {
    const double b = 0.5 * (low + high);
    (pressure_at(b, b, e) > 0 ? low : high) = b;
  }
  const double rupture = low, carried = 1 + e * std::cos(rupture);
  double area = 0;
  constexpr int pieces = 400;
  for (int k = 0; k <= pieces; ++k)
    area += (k == 0 || k == pieces ? 1 : (k % 2 == 1 ? 4 : 2)) * pressure_at(rupture, rupture * k / pieces, e);
  area *= rupture / pieces / 3 * 6 * 0.0277 * 300 * std::pow(0.05 / kClearance, 2);
  double last = 0;
  for (const int n : {60, 120, 240}) {
    Mesh m = mesh_of(n, 6, 1);
    m.length = 100;  // so long that the ends do not matter in the middle
    const Rows rows(m, PETSC_COMM_WORLD);
    FilmFlow film(rows, oil(m, 0, 0), thickness(rows, e));
    film.set_temperature(uniform(rows, 313));
    (void)film.solve();
    double sums[3] = {};  // area, how far theta h is off in the cavity, nodes there
    if (rows.begin() <= 3 && rows.end() > 3)
      for (int i = 0; i < n; ++i) {
        const auto node = static_cast<std::size_t>(rows.node(i, 3));
        sums[0] += film.pressure()[node] * 2 * pi / n;
        const double t = std::fmod(m.theta(i) + pi, 2 * pi);
        if (t < rupture + 2 * 2 * pi / n) continue;
        const double middle = 1 + e * std::cos(t + pi / n);  // at the face behind
        sums[1] = std::max(sums[1], std::abs(film.fill()[node] * middle / carried - 1));
        sums[2] += 1;
      }
    MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    const double error = std::abs(sums[0] / area - 1);
    EXPECT_GT(sums[2], n / 5);
    EXPECT_LT(sums[1], 12.0 / n);
    EXPECT_LT(error, 3.0 / n);
    if (last > 0) {
      EXPECT_GT(std::log2(last / error), 0.8) << n;
    }
    last = error;
  }
}

// What flows balances in every cell, oil comes from the groove alone, and what the shaft loses is heat and work.
TEST(FilmConserving, KeepsItsMassAndItsHeat) {
  for (const Turbulence law : {Turbulence::laminar, Turbulence::ng_pan}) {
    const Rows rows(mesh_of(40, 12, 4), PETSC_COMM_WORLD);
    const Mesh& m = rows.mesh();
    FilmFlowOptions o = oil(m, 7e4, 2);
    o.turbulence = law;
    FilmFlow film(rows, o, thickness(rows, 0.7));
    std::vector<double> t = uniform(rows, 313);
    film.set_temperature(t);
    EXPECT_LE(film.solve(), 20);
    const Flow flow = film.flow();
    const FlowReport r = film.report(flow);
    const double passing = 860 * 15 * kClearance * 0.08;
    EXPECT_LT(r.defect, 1e-12 * passing);
    EXPECT_NEAR(r.inflow, r.outflow, 1e-11 * passing);
    EXPECT_NEAR(r.heat + r.expansion, r.power, 1e-11 * r.power);
    EXPECT_GE(*std::ranges::min_element(flow.heat), -1e-15 * r.heat);
    EXPECT_GE(*std::ranges::min_element(film.pressure()), 0);
    double least = *std::ranges::min_element(film.fill());
    EXPECT_GT(least, 0);
    MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
    EXPECT_LT(least, 0.6);
    for (int j = std::max(1, rows.begin()); j < std::min(12, rows.end()); ++j)
      for (int i = 0; i < 40; ++i) {
        const auto node = static_cast<std::size_t>(rows.node(i, j));
        EXPECT_LE(film.pressure()[node] * (1 - film.fill()[node]), 0);
        if (std::abs(i - 20) > 2) {
          EXPECT_EQ(flow.inflow[4 * node], 0) << i << " " << j;
        }
      }
  }
}

TEST(FilmConserving, DerivativesAreExact) {
  const Rows rows(mesh_of(24, 8, 2), PETSC_COMM_WORLD);
  FilmFlow film(rows, oil(rows.mesh(), 7e4, 1), thickness(rows, 0.7));
  film.set_temperature(uniform(rows, 313));
  (void)film.solve();
  const core::Vector x = core::duplicate(film.state()), d = core::duplicate(x.get()), y = core::duplicate(x.get()),
                     g = core::duplicate(x.get()), high = core::duplicate(x.get());
  PetscInt first = 0;
  core::check(VecGetOwnershipRange(d.get(), &first, nullptr));
  {
    // Signs alternate: pressures and empty shares upstream and downstream of each other.
    const core::WriteArray a(x.get()), b(d.get());
    for (PetscInt i = 0; i < a.size(); ++i) {
      a[i] = 1e5 * (std::sin(0.7 * static_cast<double>(first + i)) > 0 ? 1 : -0.5);
      b[i] = 1e4 * std::sin(1.3 * static_cast<double>(first + i));
    }
  }
  film.jacobian(x.get(), film.matrix());
  core::check(MatMult(film.matrix(), d.get(), y.get()));
  // Of the first degree on both sides of u = 0.
  for (const double step : {1.0, 1e-2}) {
    film.residual(x.get(), g.get());
    core::Vector moved = core::duplicate(x.get());
    core::check(VecWAXPY(moved.get(), step, d.get(), x.get()));
    film.residual(moved.get(), high.get());
    core::check(VecAXPY(high.get(), -1, g.get()));
    core::check(VecScale(high.get(), 1 / step));
    core::check(VecAXPY(high.get(), -1, y.get()));
    EXPECT_LT(core::norm(high.get()), 1e-10 * core::norm(y.get())) << step;
  }
}

// Film and bush together: the balance closes, nothing is colder than what comes in, and without oil that is invented
// the film behind the rupture is warmer than by Reynolds' condition.
TEST(FilmConserving, BalanceOfABearingCloses) {
  double mean[2] = {}, entering[2] = {};
  for (const int k : {0, 1}) {
    const Rows rows(mesh_of(40, 8, 6), PETSC_COMM_WORLD);
    ThdSetup setup;
    setup.flow = oil(rows.mesh(), 7e4, 2);
    setup.flow.fluid.viscosity = Vogel{0.0277, 313.15, 800, 150};
    if (k == 0) setup.flow.cavitation = FilmFlowOptions::Cavitation::reynolds;
    setup.ambient = 313.15;
    setup.bush.type = WallOptions::Type::solid;
    setup.bush.conductivity = 50;
    setup.bush.radius = 0.1;
    setup.bush.convection = 80;
    setup.bush.ambient = 313.15;
    setup.journal.type = WallOptions::Type::adiabatic;
    ThdSolver thd(rows, setup, thickness(rows, 0.7));
    EXPECT_TRUE(thd.solve().converged);
    const FlowReport r = thd.flow().report(thd.flows());
    EXPECT_LT(std::abs(thd.budget().residual()), 1e-8 * r.power) << k;
    EXPECT_GE(*std::ranges::min_element(thd.temperature()), 313.15 - 1e-6) << k;
    entering[k] = r.inflow;
    double sums[2] = {};
    for (const double t : thd.temperature()) {
      sums[0] += t;
      sums[1] += 1;
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    mean[k] = sums[0] / sums[1];
  }
  EXPECT_GT(mean[1], mean[0]);
  EXPECT_GT(entering[1], 0);
}

TEST(FilmConserving, RefusesWhatHasNoAnswer) {
  const Rows rows(mesh_of(16, 8, 2), PETSC_COMM_WORLD);
  FilmFlowOptions o = oil(rows.mesh(), 0, 0);
  o.speed = 0;
  EXPECT_THROW(FilmFlow(rows, o, thickness(rows, 0.5)), core::Error);
}

}  // namespace
}  // namespace whirl::thermal
