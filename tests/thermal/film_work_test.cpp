// What pressure does in a film.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "whirl/thermal/film_flow.hpp"

namespace whirl::thermal {
namespace {

struct Work {
  double expansion = 0, power = 0, exact = 0;
};

// A gas film of one temperature, bearing A of Skarolek (2011) with `orifices`.
Work work_of(int around, int along, int orifices, double speed) {
  Mesh mesh;
  mesh.around = around;
  mesh.along = along;
  mesh.across = 2;
  mesh.radius = 0.015;
  mesh.length = 0.03;
  const Rows rows(mesh, PETSC_COMM_WORLD);
  FilmFlowOptions o;
  o.fluid.gas = true;
  o.fluid.viscosity = ConstantViscosity{1.846e-5};
  o.ambient = 101325;
  o.speed = speed;
  for (int k = 0; k < orifices; ++k) o.orifices.push_back({k * around / orifices, along / 2, 2e-4, 5e5, 300});
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < around; ++i) h.push_back(2e-5 * (1 - 0.5 * std::cos(mesh.theta(i))));
  FilmFlow film(rows, o, h);
  film.set_temperature(std::vector<double>(h.size() * 2, 300));
  (void)film.solve();
  const FlowReport report = film.report(film.flow());
  Work out{report.expansion, report.power, 0};
  const std::vector<double> flows = film.orifice_flows();
  for (std::size_t k = 0; k < flows.size(); ++k) {
    const int j = o.orifices[k].j;
    double p = 0;
    if (j >= rows.begin() && j < rows.end())
      p = film.pressure()[static_cast<std::size_t>(rows.node(o.orifices[k].i, j))];
    MPI_Allreduce(MPI_IN_PLACE, &p, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    out.exact -= 286.7 * 300 * flows[k] * std::log(p / 101325);
  }
  return out;
}

// At one temperature the work is -r T sum mdot ln(p_in/p_out): none of a film that draws in and lets out at one
// pressure.
TEST(FilmWork, OfASelfActingFilmVanishesWithTheMesh) {
  double before = 0;
  for (const int m : {2, 4, 8}) {
    const Work w = work_of(24 * m, 8 * m, 0, 1e4);
    EXPECT_GT(w.power, 10);
    if (m > 2) {
      EXPECT_GT(std::log2(std::abs(before / w.expansion)), 1.7) << m;
    }
    before = w.expansion;
  }
  EXPECT_LT(std::abs(before), 0.1);
}

// Beside an orifice the pressure changes over a step by as much on any mesh, so that a part stays.
TEST(FilmWork, OfFedFilmsIsThatOfTheirFlows) {
  for (const double speed : {0.0, 1e4}) {
    const Work w = work_of(192, 64, 8, speed);
    EXPECT_LT(w.expansion, -5);
    EXPECT_NEAR(w.expansion, w.exact, 0.003 * std::abs(w.exact)) << speed;
  }
}

// A liquid in two layers of different viscosity is pressed out of a ring in the middle towards both ends: flow, and
// heat that is all the work of pressure.
TEST(FilmWork, OfTwoLayersUnderPressureIsExact) {
  Mesh mesh;
  mesh.around = 12;
  mesh.along = 6;
  mesh.across = 2;
  mesh.radius = 0.015;
  mesh.length = 0.03;
  const Rows rows(mesh, PETSC_COMM_WORLD);
  FilmFlowOptions o;
  o.fluid.density = 800;
  o.fluid.viscosity = Vogel{0.02, 313.15, 800, 150};
  o.feeds.push_back({0, 11, 3, 3, 1e5});
  const double d = 5e-5;  // of a layer
  const auto nodes = static_cast<std::size_t>(rows.count() * 12);
  FilmFlow film(rows, o, std::vector<double>(nodes, 2 * d));
  std::vector<double> t(2 * nodes, 310);
  for (std::size_t k = 1; k < t.size(); k += 2) t[k] = 350;
  film.set_temperature(t);
  (void)film.solve();
  const double m1 = viscosity(o.fluid.viscosity, 310).value, m2 = viscosity(o.fluid.viscosity, 350).value;
  // mu u' = g s - tau, u = 0 at both walls.
  const double g = -1e5 / 0.015, tau = g * (d * d / (2 * m1) + 3 * d * d / (2 * m2)) / (d / m1 + d / m2);
  const double first = (g * d * d * d / 6 - tau * d * d / 2) / m1;
  const double second = (g * d * d / 2 - tau * d) / m1 * d + (g * 2 * d * d * d / 3 - tau * d * d / 2) / m2;
  const Flow flow = film.flow();
  for (int j = std::max(rows.begin(), 4); j < std::min(rows.end(), 6); ++j) {
    const auto c = static_cast<std::size_t>(rows.cell(0, 5, j));
    EXPECT_NEAR(flow.along[c], 800 * first * mesh.dx(), 1e-9 * flow.along[c]);
    EXPECT_NEAR(flow.along[c + 1], 800 * second * mesh.dx(), 1e-9 * flow.along[c + 1]);
  }
  const FlowReport report = film.report(flow);
  const double work = 2 * (first + second) * 2 * std::numbers::pi * 0.015 * 1e5;
  EXPECT_NEAR(report.expansion, -work, 1e-9 * work);
  EXPECT_NEAR(report.heat, work, 1e-9 * work);
}

// A hot gas at rest flows as a gas whose viscosity is larger by what its density is less.
TEST(FilmWork, HotGasFlowsAsAThickerOne) {
  Mesh mesh;
  mesh.around = 24;
  mesh.along = 8;
  mesh.across = 3;
  mesh.radius = 0.015;
  mesh.length = 0.03;
  const Rows rows(mesh, PETSC_COMM_WORLD);
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < 24; ++i) h.push_back(2e-5 * (1 - 0.5 * std::cos(mesh.theta(i))));
  const auto pressure = [&](const Viscosity& law, double temperature) {
    FilmFlowOptions o;
    o.fluid.gas = true;
    o.fluid.viscosity = law;
    o.ambient = 101325;
    for (int k = 0; k < 8; ++k) o.orifices.push_back({3 * k, 4, 2e-4, 5e5, 300});
    FilmFlow film(rows, o, h);
    film.set_temperature(std::vector<double>(h.size() * 3, temperature));
    (void)film.solve();
    return film.pressure();
  };
  const double thick = viscosity(Sutherland{}, 360).value * 360 / 300;
  EXPECT_GT(thick, 1.3 * 1.846e-5);
  const std::vector<double> hot = pressure(Sutherland{}, 360), other = pressure(ConstantViscosity{thick}, 300);
  for (std::size_t k = 0; k < hot.size(); ++k) EXPECT_NEAR(hot[k], other[k], 1e-9 * other[k]);
}

}  // namespace
}  // namespace whirl::thermal
