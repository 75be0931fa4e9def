// Velocity half-way between bush and journal.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "whirl/thermal/film_flow.hpp"

namespace whirl::thermal {
namespace {

constexpr double clearance = 2e-5, viscosity = 0.02, speed = 1000, radius = 0.015, surface = speed * radius;

std::size_t at(PetscInt k) {
  return static_cast<std::size_t>(k);
}

Mesh mesh_of(int around, int along, int across, double length = 0.03) {
  Mesh mesh;
  mesh.around = around;
  mesh.along = along;
  mesh.across = across;
  mesh.radius = radius;
  mesh.length = length;
  return mesh;
}

std::vector<double> thickness_of(const Rows& rows, double eccentricity) {
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < rows.mesh().nodes_around(); ++i)
      h.push_back(clearance * (1 - eccentricity * std::cos(rows.mesh().theta(i))));
  return h;
}

FilmFlowOptions oil() {
  FilmFlowOptions o;
  o.fluid.density = 860;
  o.fluid.viscosity = ConstantViscosity{viscosity};
  o.speed = speed;
  return o;
}

// Layers of 300, 330, 360 K ... from the bush to the journal.
std::vector<double> layered(const Rows& rows) {
  std::vector<double> t;
  for (PetscInt c = 0; c < rows.count() * rows.mesh().nodes_around(); ++c)
    for (int k = 0; k < rows.mesh().across; ++k) t.push_back(300 + 30 * k);
  return t;
}

// The greatest difference on any rank.
double furthest(const Rows& rows, const std::vector<double>& values, const std::function<double(int, int)>& wanted) {
  double most = 0;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < rows.mesh().nodes_around(); ++i)
      most = std::max(most, std::abs(values[at(rows.node(i, j))] - wanted(i, j)));
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, rows.comm());
  return most;
}

// Dragged between a ring groove of 1 MPa at mid-length and the ends: U/2 around, h^2 p'/(8 mu) along.
TEST(FilmMiddle, IsThatOfCouetteAndPoiseuille) {
  for (const int layers : {1, 2, 3, 6}) {
    const Rows rows(mesh_of(12, 8, layers), PETSC_COMM_WORLD);
    FilmFlowOptions options = oil();
    options.feeds.push_back({0, 11, 4, 4, 1e6});
    FilmFlow film(rows, options, thickness_of(rows, 0));
    film.set_temperature(layered(rows));  // the viscosity does not depend on it
    (void)film.solve();
    const FilmFlow::Velocity v = film.middle();
    const double along = clearance * clearance * 1e6 / 0.015 / (8 * viscosity);
    EXPECT_LT(furthest(rows, v.around, [](int, int) { return surface / 2; }), 1e-11 * surface) << layers;
    EXPECT_LT(furthest(rows, v.along, [&](int, int j) { return j < 4   ? -along
                                                               : j > 4 ? along
                                                                       : 0; }), 1e-9 * along)
        << layers;
  }
}

// Each layer has a viscosity of its own: u = U J/F_0, and a parabola in each, joined with its stress.
TEST(FilmMiddle, KnowsTheViscosityOfItsLayers) {
  for (const int layers : {2, 3, 5, 8}) {
    const Rows rows(mesh_of(12, 8, layers), PETSC_COMM_WORLD);
    FilmFlowOptions options = oil();
    options.fluid.viscosity = Sutherland{};
    options.feeds.push_back({0, 11, 4, 4, 1e3});
    FilmFlow film(rows, options, thickness_of(rows, 0));
    film.set_temperature(layered(rows));
    (void)film.solve();
    const FilmFlow::Velocity v = film.middle();
    // J, I by fine sums of int ds/mu and int s ds/mu: the midpoint rule is exact for both.
    double j_half = 0, i_half = 0, j_all = 0, i_all = 0;
    const int steps = 2 * layers;
    for (int k = 0; k < steps; ++k) {
      const double ds = clearance / steps, s = (k + 0.5) * ds;
      const double mu = thermal::viscosity(options.fluid.viscosity, 300 + 30 * (k / 2)).value;
      j_all += ds / mu;
      i_all += s * ds / mu;
      if (k < layers) {
        j_half += ds / mu;
        i_half += s * ds / mu;
      }
    }
    const double along = 1e3 / 0.015 * (i_half - i_all / j_all * j_half);
    EXPECT_LT(furthest(rows, v.around, [&](int, int) { return surface * j_half / j_all; }), 1e-11 * surface);
    EXPECT_LT(furthest(rows, v.along, [&](int, int j) { return j < 4   ? along
                                                               : j > 4 ? -along
                                                                       : 0; }),
              1e-9 * std::abs(along))
        << layers;
    EXPECT_GT(std::abs(j_half / j_all - 0.5), 0.01);
  }
}

// The long bearing of Sommerfeld (1904), u = U (3 h_m/h - 1)/4, and the short one of Ocvirk (1953),
// w = -3/4 U (h'/h) z, to their ends: of second order in the step around.
TEST(FilmMiddle, MeetsTheLongAndTheShortBearingWithSecondOrder) {
  const double e = 0.5, mean = 2 * clearance * (1 - e * e) / (2 + e * e);
  double before[2] = {};
  for (const int n : {32, 64, 128}) {
    const auto h = [&](int i) { return clearance * (1 - e * std::cos(2 * M_PI * i / n)); };
    const auto run = [&](double length, int along, bool long_one) {
      const Rows rows(mesh_of(n, along, 2, length), PETSC_COMM_WORLD);
      FilmFlow film(rows, oil(), thickness_of(rows, e));
      film.set_temperature(layered(rows));
      (void)film.solve();
      const FilmFlow::Velocity v = film.middle();
      if (!long_one) {
        const double largest = surface * length / radius;
        return furthest(rows, v.along,
                        [&](int i, int j) {
                          const double slope = clearance * e * std::sin(2 * M_PI * i / n) / radius;
                          return -0.75 * surface * slope / h(i) * rows.mesh().z(j);
                        }) /
               largest;
      }
      // Far from the ends alone.
      return furthest(rows, v.around,
                      [&](int i, int j) {
                        return j == along / 2 ? surface * (3 * mean / h(i) - 1) / 4 : v.around[at(rows.node(i, j))];
                      }) /
             surface;
    };
    const double error[2] = {run(40 * radius, 40, true), run(1e-5 * radius, 8, false)};
    for (int k = 0; k < 2; ++k) {
      EXPECT_GT(error[k], 0);
      if (n > 32) {
        EXPECT_GT(std::log2(before[k] / error[k]), 1.9) << n << ": " << before[k] << ", " << error[k];
      }
      if (n == 128) {
        EXPECT_LT(error[k], 2e-3);
      }
      before[k] = error[k];
    }
  }
}

// Of one viscosity u - U/2 is 3/2 of its mean across, so that it and the mass flow say the same, also of a gas.
TEST(FilmMiddle, IsThatOfTheMassFlow) {
  for (const bool gas : {false, true}) {
    const int n = 24, along = 8, layers = 3;
    const Rows rows(mesh_of(n, along, layers), PETSC_COMM_WORLD);
    FilmFlowOptions options = oil();
    options.fluid.gas = gas;
    options.fluid.viscosity = ConstantViscosity{1.8e-5};
    options.ambient = gas ? 101325 : 0;
    if (gas)
      for (int k = 0; k < 8; ++k) options.orifices.push_back({3 * k, 4, 2e-4, 5e5, 300});
    FilmFlow film(rows, options, thickness_of(rows, 0.5));
    film.set_temperature(std::vector<double>(at(rows.count() * n * layers), 300));
    (void)film.solve();
    const Flow flow = film.flow();
    const FilmFlow::Velocity v = film.middle();
    const auto around = [&](int i, int j) {
      const int next = (i + 1) % n;
      const auto a = at(rows.node(i, j)), b = at(rows.node(next, j));
      const double h =
          0.5 * clearance * (2 - 0.5 * (std::cos(rows.mesh().theta(i)) + std::cos(rows.mesh().theta(next))));
      const double rho = gas ? options.fluid.rho(0.5 * (film.pressure()[a] + film.pressure()[b]), 300) : 860;
      double mass = 0;
      for (int k = 0; k < layers; ++k) mass += flow.around[at(rows.cell(k, i, j))];
      return surface / 2 + 1.5 * (mass / (rho * h * rows.mesh().depth(j)) - surface / 2);
    };
    EXPECT_LT(furthest(rows, v.around, [&](int i, int j) { return 0.5 * (around(i, j) + around((i + n - 1) % n, j)); }),
              1e-10 * surface);
  }
}

}  // namespace
}  // namespace whirl::thermal
