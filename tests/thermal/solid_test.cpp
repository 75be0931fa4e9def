// Conduction in bush and journal against exact and manufactured solutions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "thermal/solid_cases.hpp"

namespace whirl::thermal::test {
namespace {

constexpr double pi = std::numbers::pi;

// Q = (T_film - T_a)/(1/(h_f A_i) + ln(R_o/R)/(2 pi k L) + 1/(h A_o)); the temperature is logarithmic.
TEST(Solid, RadialConductionIsExact) {
  const Rows rows(film(6, 7), PETSC_COMM_WORLD);
  for (const double grading : {1.0, 1.4}) {
    Bush b = bush();
    b.layers = 5;
    b.grading = grading;
    b.surfaces.begin = b.surfaces.end = {};
    Solid solid = make_solid(rows, b);
    const double radius = 0.015, length = 0.03, k = 45, h = 50, h_film = 2e4, hot = 380;
    const Solution s = solve(solid, film_conductance(rows, h_film), columns(rows, [&](int, int) { return hot; }));
    const double in = 1 / (h_film * 2 * pi * radius * length), out = 1 / (h * 2 * pi * b.outer_radius * length),
                 through = 1 / (2 * pi * k * length);
    const double heat = (hot - 300) / (in + through * std::log(b.outer_radius / radius) + out);
    const core::ReadArray t(s.temperature.get());
    each(solid, [&](PetscInt at, int layer, int, int) {
      const double exact = hot - heat * (in + through * std::log(solid.shape().centre(layer) / radius));
      EXPECT_NEAR(t[at], exact, 1e-7);
    });
    const Heats heats = solid.heats(s.temperature.get(), columns(rows, [&](int, int) { return hot; }));
    EXPECT_NEAR(heats.wall, heat, 1e-7 * heat);
    EXPECT_NEAR(heats.outer, heat, 1e-7 * heat);
    for (const double wall : solid.wall_temperature(s.temperature.get(), columns(rows, [&](int, int) { return hot; })))
      EXPECT_NEAR(wall, hot - heat * in, 1e-7);
  }
}

// A shaft that conducts well is a fin: T - T_a ~ cosh(m (L - s)), m^2 = h P/(k A), with P of the surface and the bore.
// It is one from a radius beyond the film on; what the model adds across the shaft is of the order of its Biot number.
TEST(Solid, AShaftIsAFinBeyondTheFilm) {
  const Rows rows(film(4, 24), PETSC_COMM_WORLD);
  Journal j = journal();
  const double k = 4000, h = 200, radius = 0.015, bore = 0.005;
  j.length = 0.3;
  j.before = 0.1;
  j.material.conductivity = k;
  j.surfaces = {convection(h), convection(h), {}, {}};
  Solid solid = make_solid(rows, j);
  const Solution s = solve(solid, film_conductance(rows, 1e9), columns(rows, [](int, int) { return 400.0; }));
  const double m = std::sqrt(2 * h / (k * (radius - bore)));
  const std::vector<double> t = core::gather(s.temperature.get());
  for (const bool far : {false, true}) {
    const double length = far ? 0.17 : 0.1;
    double first = 0, first_exact = 0, drop = 0;
    for (int n = 0; n < solid.shape().rows(); ++n) {
      const int q = far ? n : solid.shape().rows() - 1 - n;
      const double from = (far ? 1 : -1) * solid.shape().z[static_cast<std::size_t>(q)] - 0.015;
      if (from < radius) continue;
      const double found = t[static_cast<std::size_t>(solid.cell(4, 0, q))] - 300,
                   exact = std::cosh(m * (length - from));
      if (first == 0) first = found, first_exact = exact;
      drop = 1 - exact / first_exact;
      EXPECT_NEAR(found / first, exact / first_exact, 2e-3 * drop + 1e-6) << from;
    }
    EXPECT_GT(drop, 0.03);
  }
}

// T = T_a + f(r) cos(n theta) cos(beta (z - z_0)), f = 1 - a (r - r_m)^2: every free surface of the solid is one of
// convection at T_a, with the coefficient that this temperature asks for.
struct Manufactured {
  double k = 30, ambient = 300, a = 2e3, middle = 0, wave = 2, beta = 20, centre = 0;
  [[nodiscard]] double f(double r) const { return 100 * (1 - a * (r - middle) * (r - middle)); }
  [[nodiscard]] double slope(double r) const { return -200 * a * (r - middle); }
  [[nodiscard]] double around(double theta, double z) const {
    return std::cos(wave * theta) * std::cos(beta * (z - centre));
  }
  [[nodiscard]] double at(double r, double theta, double z) const { return ambient + f(r) * around(theta, z); }
  [[nodiscard]] double source(double r, double theta, double z) const {
    const double laplacian = -200 * a + slope(r) / r - (wave * wave / (r * r) + beta * beta) * f(r);
    return -k * laplacian * around(theta, z);
  }
  [[nodiscard]] Surface outer(double r) const { return convection(-k * slope(r) / f(r), ambient); }
  [[nodiscard]] Surface inner(double r) const { return convection(k * slope(r) / f(r), ambient); }
  [[nodiscard]] Surface end(double half) const { return convection(k * beta * std::tan(beta * half), ambient); }
};

struct Errors {
  double volume = 0, wall = 0;  // K, root mean square / largest
};

Errors errors(const Rows& rows, Solid& solid, const Manufactured& exact) {
  const Cylinder& c = solid.shape();
  const core::Vector source = solid.temperature(0);
  const auto theta = [&](int i) { return c.theta[static_cast<std::size_t>(i)]; };
  const auto z = [&](int q) { return c.z[static_cast<std::size_t>(q)]; };
  {
    const core::WriteArray w(source.get());
    each(solid, [&](PetscInt at, int k, int i, int q) {
      w[at] = exact.source(c.centre(k), theta(i), z(q)) * c.volume(k, i, q);
    });
  }
  const double coefficient = 5e3, radius = c.wall_radius(), sign = c.outside ? -1 : 1;
  const auto wall = [&](int i, int j) { return exact.at(radius, rows.mesh().theta(i), rows.mesh().z(j)); };
  const std::vector<double> hot = columns(rows, [&](int i, int j) {
    const double into = sign * exact.k * exact.slope(radius) * exact.around(rows.mesh().theta(i), rows.mesh().z(j));
    return wall(i, j) + into / coefficient;
  });
  const Solution s = solve(solid, film_conductance(rows, coefficient), hot, source.get());
  double sums[2] = {0, 0};
  const core::ReadArray t(s.temperature.get());
  each(solid, [&](PetscInt at, int k, int i, int q) {
    const double e = t[at] - exact.at(c.centre(k), theta(i), z(q)), v = c.volume(k, i, q);
    sums[0] += e * e * v;
    sums[1] += v;
  });
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, rows.comm());
  Errors out{std::sqrt(sums[0] / sums[1]), 0};
  const std::vector<double> found = solid.wall_temperature(s.temperature.get(), hot), sought = columns(rows, wall);
  for (std::size_t n = 0; n < found.size(); ++n) out.wall = std::max(out.wall, std::abs(found[n] - sought[n]));
  MPI_Allreduce(MPI_IN_PLACE, &out.wall, 1, MPI_DOUBLE, MPI_MAX, rows.comm());
  return out;
}

// make(size) of a mesh that is finer by `size` in every direction.
void expect_second_order(const std::function<Errors(int)>& make) {
  const Errors coarse = make(1), middle = make(2), fine = make(4);
  EXPECT_GT(fine.volume, 0);
  EXPECT_LT(fine.volume, 0.2);
  EXPECT_GE(std::log2(middle.volume / fine.volume), 1.9) << coarse.volume << ' ' << middle.volume << ' ' << fine.volume;
  EXPECT_GE(std::log2(middle.wall / fine.wall), 1.9) << coarse.wall << ' ' << middle.wall << ' ' << fine.wall;
}

TEST(Solid, ABushConvergesAtSecondOrder) {
  for (const bool held : {false, true}) {
    Manufactured exact;
    exact.middle = 0.012;
    if (held) exact.beta = pi / 0.03;
    expect_second_order([&](int size) {
      const Rows rows(film(16 * size, 5 * size), PETSC_COMM_WORLD);
      Bush b = bush();
      b.material.conductivity = exact.k;
      b.layers = 3 * size;
      b.surfaces.outer = exact.outer(b.outer_radius);
      b.surfaces.begin = b.surfaces.end = held ? prescribed(exact.ambient) : exact.end(0.015);
      Solid solid = make_solid(rows, b);
      return errors(rows, solid, exact);
    });
  }
}

// A pad of 120 degrees whose bush ends with it, and one with a bush all around that convects in the gap.
TEST(Solid, APadsBushConvergesAtSecondOrder) {
  for (const bool ring : {false, true}) {
    Manufactured exact;
    exact.middle = ring ? 0.018 : 0.012;
    exact.wave = 3;
    expect_second_order([&](int size) {
      Mesh mesh = film(10 * size, 5 * size);
      mesh.closed = false;
      mesh.begin = pi / 3;
      mesh.extent = 2 * pi / 3;
      const Rows rows(mesh, PETSC_COMM_WORLD);
      Bush b = bush();
      b.material.conductivity = exact.k;
      b.layers = 3 * size;
      b.ring = ring;
      if (ring) b.surfaces.inner = exact.inner(mesh.radius);
      b.surfaces.outer = exact.outer(b.outer_radius);
      b.surfaces.begin = b.surfaces.end = exact.end(0.015);
      Solid solid = make_solid(rows, b);
      return errors(rows, solid, exact);
    });
  }
}

TEST(Solid, AJournalConvergesAtSecondOrder) {
  for (const bool rotating : {true, false}) {
    Manufactured exact;
    exact.middle = 0.01;
    exact.centre = 0.015;
    if (rotating) exact.wave = 0;
    expect_second_order([&](int size) {
      const Rows rows(film(rotating ? 8 : 16 * size, 6 * size), PETSC_COMM_WORLD);
      Journal j = journal();
      j.rotating = rotating;
      j.material.conductivity = exact.k;
      j.layers = 4 * size;
      j.surfaces = {exact.inner(j.bore_radius), exact.outer(0.015), exact.end(0.05), exact.end(0.05)};
      Solid solid = make_solid(rows, j);
      return errors(rows, solid, exact);
    });
  }
}

}  // namespace
}  // namespace whirl::thermal::test
