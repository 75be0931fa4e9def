// The flow of films by themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "whirl/thermal/film_flow.hpp"

namespace whirl::thermal {
namespace {

using std::numbers::pi;

// Bearing A of Skarolek (2011): R = 15 mm, L = 30 mm, c = 20 um, eight orifices of 0.2 mm at mid-length.
Mesh mesh_of_a(int around, int along, int across) {
  Mesh m;
  m.around = around;
  m.along = along;
  m.across = across;
  m.radius = 0.015;
  m.length = 0.03;
  return m;
}

std::vector<double> thickness(const Rows& rows, double clearance, double eccentricity) {
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < rows.mesh().nodes_around(); ++i)
      h.push_back(clearance * (1 - eccentricity * std::cos(rows.mesh().theta(i))));
  return h;
}

FilmFlowOptions options_of_a(const Mesh& mesh, double supply, double speed) {
  FilmFlowOptions o;
  o.fluid.gas = true;
  o.fluid.viscosity = ConstantViscosity{1.846e-5};
  o.ambient = 101325;
  o.speed = speed;
  for (int k = 0; k < 8; ++k) o.orifices.push_back({k * mesh.around / 8, mesh.along / 2, 2e-4, supply, 300});
  return o;
}

std::vector<double> uniform(const Rows& rows, double temperature) {
  return std::vector<double>(static_cast<std::size_t>(rows.count() * rows.mesh().nodes_around() * rows.mesh().across),
                             temperature);
}

struct Result {
  FlowReport report;
  double flow;
  int iterations;
};
Result bearing_a(double supply, double speed, double eccentricity, int around = 192, int along = 64, int across = 2) {
  const Rows rows(mesh_of_a(around, along, across), PETSC_COMM_WORLD);
  FilmFlow film(rows, options_of_a(rows.mesh(), supply, speed), thickness(rows, 2e-5, eccentricity));
  film.set_temperature(uniform(rows, 300));
  const int iterations = film.solve();
  const Flow flow = film.flow();
  double all = 0;
  for (const double m : film.orifice_flows()) all += m;
  return {film.report(flow), all, iterations};
}

// Loads of bearing A at 0.5 MPa and 1000 rad/s by an independent computation, good to 0.2 %.
TEST(FilmFlow, CarriesWhatTheReferenceSays) {
  const std::vector<std::pair<double, double>> loads = {{0.1, 13.24}, {0.4, 50.07}, {0.6, 67.88}, {0.8, 88.54}};
  for (const auto& [e, load] : loads) {
    const Result r = bearing_a(5e5, 1000, e);
    EXPECT_NEAR(std::hypot(r.report.force[0], r.report.force[1]), load, 0.004 * load) << e;
    EXPECT_LT(r.report.force[0], 0) << "the film pushes back";
    EXPECT_LE(r.iterations, 15);
    if (e == 0.6) {
      EXPECT_NEAR(r.flow, 1.193e-4, 0.002 * 1.193e-4);
    }
  }
}

TEST(FilmFlow, LosesWhatTheReferenceSays) {
  const Result r = bearing_a(5e5, 1e4, 0.5);
  EXPECT_NEAR(r.report.power, 69.5, 0.001 * 69.5);
}

// Mass is conserved to rounding, and what heats the gas is what the shaft loses, at rest nothing.
TEST(FilmFlow, ConservesMassAndEnergy) {
  for (const double speed : {0.0, 1e4}) {
    const Result r = bearing_a(5e5, speed, 0.5, 48, 16, 5);
    EXPECT_NEAR(r.report.inflow, r.flow, 1e-12 * r.flow);
    EXPECT_NEAR(r.report.outflow, r.flow, 1e-10 * r.flow);
    EXPECT_LT(r.report.defect, 1e-12 * r.flow);
    EXPECT_NEAR(r.report.heat, r.report.power, 1e-11 * std::max(1.0, r.report.power)) << speed;
  }
}

TEST(FilmFlow, HasExactDerivatives) {
  const Rows rows(mesh_of_a(16, 8, 3), PETSC_COMM_WORLD);
  FilmFlow film(rows, options_of_a(rows.mesh(), 5e5, 1e4), thickness(rows, 2e-5, 0.6));
  std::vector<double> t = uniform(rows, 300);
  for (std::size_t k = 0; k < t.size(); ++k) t[k] += 20 * std::sin(static_cast<double>(k));
  film.set_temperature(t);
  (void)film.solve();
  core::Vector x = core::duplicate(film.state()), d = core::duplicate(x.get()), f = core::duplicate(x.get()),
               g = core::duplicate(x.get()), y = core::duplicate(x.get());
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
  EXPECT_GT(core::norm(y.get()), 1e-9);
  for (const double step : {1e-3, 1e-4}) {
    core::check(VecWAXPY(g.get(), step, d.get(), x.get()));
    core::Vector high = core::duplicate(x.get()), low = core::duplicate(x.get());
    film.residual(g.get(), high.get());
    core::check(VecWAXPY(g.get(), -step, d.get(), x.get()));
    film.residual(g.get(), low.get());
    core::check(VecAXPY(high.get(), -1, low.get()));
    core::check(VecScale(high.get(), 0.5 / step));
    core::check(VecAXPY(high.get(), -1, y.get()));
    const double error = core::norm(high.get()) / core::norm(y.get());
    EXPECT_LT(error, 1e-9) << step;  // F is all but quadratic
  }
}

// A liquid of two layers between plates: the interface moves with U mu_1/(mu_0 + mu_1).
TEST(FilmFlow, KnowsViscosityAcrossTheFilm) {
  const Rows rows(mesh_of_a(12, 6, 2), PETSC_COMM_WORLD);
  FilmFlowOptions o;
  o.fluid.density = 800;
  o.fluid.viscosity = Vogel{0.02, 313.15, 800, 150};
  o.speed = 100;
  FilmFlow film(rows, o, thickness(rows, 1e-4, 0));
  std::vector<double> t = uniform(rows, 310);
  for (std::size_t k = 1; k < t.size(); k += 2) t[k] = 350;
  film.set_temperature(t);
  (void)film.solve();
  const double cold = viscosity(o.fluid.viscosity, 310).value, hot = viscosity(o.fluid.viscosity, 350).value;
  const double surface = 1.5, middle = surface * hot / (cold + hot);
  const Flow flow = film.flow();
  const double width = 0.03 / 6;
  for (int j = rows.begin(); j < rows.end(); ++j) {
    if (j == 0 || j == 6) continue;
    const auto c = static_cast<std::size_t>(rows.cell(0, 3, j));
    EXPECT_NEAR(flow.around[c], 800 * 5e-5 * middle / 2 * width, 1e-15);
    EXPECT_NEAR(flow.around[c + 1], 800 * 5e-5 * (middle + surface) / 2 * width, 1e-15);
  }
  const double tau = surface / (5e-5 / cold + 5e-5 / hot);
  EXPECT_NEAR(film.report(flow).friction, tau * 2 * pi * 0.015 * 0.03 * 0.015, 1e-12);
}

// Half a long journal bearing without cavitation: Sommerfeld's pressure, second order.
TEST(FilmFlow, FindsSommerfeldsPressure) {
  double last = 0;
  for (const int n : {24, 48, 96}) {
    Mesh m = mesh_of_a(n, 6, 2);
    m.length = 30;  // so long that the ends do not matter in the middle
    const Rows rows(m, PETSC_COMM_WORLD);
    FilmFlowOptions o;
    o.fluid.density = 800;
    o.fluid.viscosity = ConstantViscosity{0.01};
    o.speed = 100;
    const double e = 0.5, c = 2e-5;
    FilmFlow film(rows, o, thickness(rows, c, e));
    film.set_temperature(uniform(rows, 300));
    (void)film.solve();
    double error = 0;
    if (rows.begin() <= 3 && rows.end() > 3)
      for (int i = 0; i < n; ++i) {
        // h = c (1 - e cos theta): the widest gap lies at theta = pi, where Sommerfeld's angle is zero.
        const double t = m.theta(i) - pi;
        const double exact = 6 * 0.01 * 100 * std::pow(0.015 / c, 2) * e * std::sin(t) * (2 + e * std::cos(t)) /
                             ((2 + e * e) * std::pow(1 + e * std::cos(t), 2));
        const double mean = film.pressure()[static_cast<std::size_t>(rows.node(0, 3))];
        error = std::max(error, std::abs(film.pressure()[static_cast<std::size_t>(rows.node(i, 3))] - mean - exact));
      }
    MPI_Allreduce(MPI_IN_PLACE, &error, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
    if (last > 0) {
      EXPECT_GT(std::log2(last / error), 1.9) << n;
    }
    last = error;
  }
}

// No pressure below that of the ambient, and none there that a film under tension would have.
TEST(FilmFlow, RupturesByReynolds) {
  const Rows rows(mesh_of_a(48, 16, 2), PETSC_COMM_WORLD);
  FilmFlowOptions o;
  o.fluid.density = 800;
  o.fluid.viscosity = ConstantViscosity{0.01};
  o.speed = 100;
  o.cavitation = FilmFlowOptions::Cavitation::reynolds;
  const double e = 0.6, c = 2e-5;
  FilmFlow film(rows, o, thickness(rows, c, e));
  film.set_temperature(uniform(rows, 300));
  (void)film.solve();
  double least = 0, most = 0;
  for (const double p : film.pressure()) {
    least = std::min(least, p);
    most = std::max(most, p);
  }
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, PETSC_COMM_WORLD);
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  EXPECT_GE(least, -1e-9 * most);
  // Raimondi and Boyd's table has S = 0.121 at this eccentricity, L/D = 1; films that may begin anywhere carry as much
  // within a per cent.
  const FlowReport r = film.report(film.flow());
  const double load = std::hypot(r.force[0], r.force[1]);
  const double s = 0.01 * (100 / (2 * pi)) * 0.03 * 0.03 * std::pow(0.015 / c, 2) / load;
  EXPECT_NEAR(s, 0.121, 0.002);
}

// From no pressure the border of the cavity moves by a node a step; from that on every other node it is found in a few.
TEST(FilmFlow, FindsWhereItRupturesFromCold) {
  FilmFlowOptions o;
  o.fluid.viscosity = ConstantViscosity{0.0277};
  o.fluid.density = 860;
  o.speed = 157;
  o.cavitation = FilmFlowOptions::Cavitation::reynolds;
  Mesh m = mesh_of_a(160, 16, 1);
  m.radius = 0.05;
  m.length = 0.08;
  const Rows rows(m, PETSC_COMM_WORLD);
  o.feeds.push_back({-4, 4, 1, 15, 7e4});
  const std::vector<double> h = thickness(rows, 145e-6, 0.7);
  FilmFlow cold(rows, o, h), slow(rows, o, h);
  for (FilmFlow* film : {&cold, &slow}) film->set_temperature(uniform(rows, 313));
  slow.start(std::vector<double>(h.size(), 0.0));
  const int few = cold.solve(), many = slow.solve();
  EXPECT_LE(few, 6);
  EXPECT_GT(many, 2 * few);
  double off = 0;
  for (std::size_t k = 0; k < h.size(); ++k) off = std::max(off, std::abs(cold.pressure()[k] - slow.pressure()[k]));
  EXPECT_LT(off, 1e-6 * cold.report(cold.flow()).highest);
}

TEST(Orifice, ChokesAndFlowsBack) {
  const PerfectGas air;
  EXPECT_EQ(nozzle(air, 5e5, 300, 1e5).value, nozzle(air, 5e5, 300, 2e5).value);
  // Choked air: 0.0404 sqrt(K s^2/m^2) p/sqrt(T).
  EXPECT_NEAR(nozzle(air, 5e5, 300, 1e5).value, 0.6847 * 5e5 / std::sqrt(286.7 * 300), 1e-3 * 1167);
  EXPECT_EQ(nozzle(air, 5e5, 300, 5e5).value, 0);
  EXPECT_LT(nozzle(air, 5e5, 300, 6e5).value, 0);
  for (const double p : {1e5, 3e5, 4.9e5, 4.999e5, 5.001e5, 5.5e5, 9e5}) {
    const double d = 1e-3 * p * 1e-3;
    EXPECT_NEAR(nozzle(air, 5e5, 300, p).slope,
                (nozzle(air, 5e5, 300, p + d).value - nozzle(air, 5e5, 300, p - d).value) / (2 * d),
                1e-5 * std::abs(nozzle(air, 5e5, 300, p).slope) + 1e-12)
        << p;
  }
}

TEST(Viscosity, HasExactSlopes) {
  const std::vector<Viscosity> laws = {ConstantViscosity{0.01}, Sutherland{}, Vogel{0.02, 313.15, 800, 150},
                                       Walther{{46e-6, 6.8e-6}, {313.15, 373.15}, 863},
                                       Quadratic{0.0277, 40, {3.287, -3.064, 0.777}}};
  for (const Viscosity& law : laws)
    for (const double t : {300.0, 330.0, 400.0}) {
      const double d = 1e-3, slope = (viscosity(law, t + d).value - viscosity(law, t - d).value) / (2 * d);
      EXPECT_NEAR(viscosity(law, t).slope, slope, 1e-6 * viscosity(law, t).value) << law.index() << " " << t;
      EXPECT_GT(viscosity(law, t).value, 0);
    }
  EXPECT_NEAR(viscosity(laws[3], 313.15).value, 46e-6 * 863, 1e-9);
  EXPECT_NEAR(viscosity(laws[4], 313.15).value, 0.0277, 1e-12);
}

}  // namespace
}  // namespace whirl::thermal
