// The energy equation of a film against exact solutions.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>

#include "support/heated_film.hpp"
#include "whirl/thermal/energy.hpp"

namespace whirl::thermal {
namespace {

using test::HeatedFilm;
constexpr double pi = std::numbers::pi;

Mesh strip(int around, int along, int across, bool closed) {
  Mesh m;
  m.around = around;
  m.along = along;
  m.across = across;
  m.closed = closed;
  m.radius = 1;
  m.extent = 1;  // m around
  m.length = 0.7;
  return m;
}

double largest(const HeatedFilm& film, Vec t, const std::function<double(int, int, int)>& exact) {
  const core::ReadArray found(t);
  double out = 0;
  film.each(
      [&](int k, int i, int j) { out = std::max(out, std::abs(found[film.rows.cell(k, i, j)] - exact(k, i, j))); });
  MPI_Allreduce(MPI_IN_PLACE, &out, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  return out;
}

// T = T_w + mu U^2/(2 k) eta (1 - eta) between two walls, or mu U^2/k (eta - eta^2/2) with the upper one adiabatic.
// Finite volumes are exact but for mu U^2/(8 k l^2), which stems from the half layer at a wall.
TEST(Energy, CouetteFlowBetweenWallsIsHeated) {
  const double mu = 0.02, speed = 10, k = 0.13, c = 2000, h = 1e-4;
  for (const int l : {4, 8}) {
    HeatedFilm film(
        strip(6, 7, l, true), PETSC_COMM_WORLD, [=](double, double) { return h; },
        [=](double, double z0, double z1, double a, double b) { return 400 * h * (z1 - z0) * (b * b - a * a); },
        [](double, double, double, double, double) { return 0.0; });
    film.each([&](int q, int i, int j) {
      film.flow.heat[film.cell(q, i, j)] = mu * speed * speed / h * film.mesh.width(i) * film.mesh.depth(j) / l;
    });
    for (const bool insulated : {false, true}) {
      Energy energy(film.rows, film.flow, {c, k, 2}, film.thickness,
                    {film.isothermal(k, 320), insulated ? film.adiabatic() : film.isothermal(k, 320), 300, {}, {}});
      core::Vector t = film.temperature(300);
      ASSERT_TRUE(energy.solve(t.get()).converged);
      const double rise = mu * speed * speed / k;
      EXPECT_LT(largest(film, t.get(),
                        [&](int q, int, int) {
                          const double eta = film.middle(q);
                          return 320 + rise * (insulated ? eta - eta * eta / 2 : eta * (1 - eta) / 2) +
                                 rise / (8 * l * l);
                        }),
                1e-7);
      const EnergyBudget b = energy.budget(t.get());
      EXPECT_NEAR(b.bush + b.journal, b.heat, 1e-9 * b.heat);
      EXPECT_NEAR(b.journal / b.heat, insulated ? 0.0 : 0.5, 1e-9);
    }
  }
}

// The oldest problem of heat in a channel: oil of one temperature enters between walls of another. The profile of
// Poiseuille flow solves Y'' + lambda 6 eta (1 - eta) Y = 0, here expanded in sines.
class Graetz {
public:
  Graetz() {
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(terms, terms), mass = stiffness;
    for (int a = 0; a < terms; ++a) {
      stiffness(a, a) = order(a) * order(a) * pi * pi / 2;
      for (int b = 0; b < terms; ++b) mass(a, b) = 0.5 * (bend(order(a) - order(b)) - bend(order(a) + order(b)));
    }
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(stiffness, mass);
    lambda_ = solver.eigenvalues();
    shapes_ = solver.eigenvectors();
    Eigen::VectorXd one(terms);  // integral of 6 eta (1 - eta) sin(n pi eta)
    for (int a = 0; a < terms; ++a) one(a) = 24 / std::pow(order(a) * pi, 3);
    weights_ = shapes_.transpose() * one;
  }
  // Of (T - T_w)/(T_0 - T_w), weighted with the flow, at x alpha/(u h^2).
  [[nodiscard]] double mean(double x) const { return (weights_.array().square() * (-lambda_ * x).array().exp()).sum(); }

private:
  static constexpr int terms = 60;
  static double order(int a) { return 2 * a + 1; }
  // Integral of 6 eta (1 - eta) cos(n pi eta), n even.
  static double bend(double n) { return n == 0 ? 1.0 : -12 / (n * n * pi * pi); }
  Eigen::VectorXd lambda_, weights_;
  Eigen::MatrixXd shapes_;
};

TEST(Energy, GraetzEntryIsOfSecondOrder) {
  const Graetz exact;
  EXPECT_NEAR(exact.mean(0), 1, 2e-4);  // so many terms
  const double h = 1e-3, c = 2000, k = 0.13;
  std::vector<double> errors;
  for (const int l : {8, 16, 32}) {
    const double rate = k / c * 1.0 / (h * 0.1);  // kg/(s m), so that x alpha/(u h^2) is 0.1 at the outlet
    HeatedFilm film(
        strip(3 * l, 5, l, false), PETSC_COMM_WORLD, [=](double, double) { return h; },
        [=](double, double z0, double z1, double a, double b) {
          return rate * (z1 - z0) * (b * b * (3 - 2 * b) - a * a * (3 - 2 * a));
        },
        [](double, double, double, double, double) { return 0.0; });
    Energy energy(film.rows, film.flow, {c, k, 2}, film.thickness,
                  {film.isothermal(k, 300), film.isothermal(k, 300), 310, {}, {}});
    core::Vector t = film.temperature(310);
    ASSERT_TRUE(energy.solve(t.get()).converged);
    const core::ReadArray found(t.get());
    double carried = 0;
    for (int j = film.rows.begin(); j < film.rows.end(); ++j)
      for (int q = 0; q < l; ++q)
        carried += film.flow.around[film.cell(q, 3 * l, j)] * (found[film.rows.cell(q, 3 * l, j)] - 300);
    MPI_Allreduce(MPI_IN_PLACE, &carried, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    errors.push_back(std::abs(carried / (rate * 0.7 * 10) - exact.mean(0.1)));
  }
  EXPECT_LT(errors[2], 1e-3);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 1.9) << errors[0] << ' ' << errors[1] << ' ' << errors[2];
}

// A smooth temperature in a flow from two stream functions, which keeps mass cell by cell; heated by what its fluxes
// leave in each cell. Returns the mean of the error over the volume.
double manufactured(int cells, int order, bool closed) {
  const double k = 0.02, c = 3;
  const auto gap = [](double x, double z) {
    return 0.05 + 0.015 * std::cos(2 * pi * x) + 0.01 * std::cos(2 * pi * z / 0.7);
  };
  const auto t = [](double x, double z, double zeta) {
    return 300 + std::sin(2 * pi * x + 0.5) * std::cos(2 * pi * z / 0.7) * (1 + std::sin(2 * zeta)) + 3 * zeta * zeta;
  };
  // Above the part that leaves the film, whirls between the walls.
  const auto a = [](double x, double zeta) {
    return zeta * zeta * (3 - 2 * zeta) + std::sin(2 * pi * x) * std::pow(zeta * (1 - zeta), 2);
  };
  const auto b = [](double z, double zeta) { return 4 * std::pow(std::cos(pi * z / 0.7) * zeta * (1 - zeta), 2); };
  HeatedFilm film(
      strip(5 * cells / 2, 2 * cells, cells, closed), PETSC_COMM_WORLD, gap,
      [&](double x, double z0, double z1, double e, double f) { return (z1 - z0) * (a(x, f) - a(x, e)); },
      [&](double z, double x0, double x1, double e, double f) { return (x1 - x0) * (b(z, f) - b(z, e)); });
  const Mesh& m = film.mesh;
  const int n = m.nodes_around(), l = m.across;
  const double e = 1e-5;
  Surroundings s{film.isothermal(k, 0), film.isothermal(k, 0), 300, {}, {}};
  film.each([&](int q, int i, int j) {
    const double x = film.x(i), z = m.z(j), zeta = film.middle(q), h = gap(x, z);
    const auto around = [&](double at) {  // carried and conducted through the face there
      const double flow = (film.far(j) - film.near(j)) * (a(at, film.zeta(q + 1)) - a(at, film.zeta(q)));
      const bool end = !closed && (at == 0 || at == 1);
      return c * flow * (t(at, z, zeta) - 300) -
             (end ? 0 : k * m.depth(j) / l * gap(at, z) * (t(at + e, z, zeta) - t(at - e, z, zeta)) / (2 * e));
    };
    const auto along = [&](double at) {
      const double flow = (film.right(i) - film.left(i)) * (b(at, film.zeta(q + 1)) - b(at, film.zeta(q)));
      return c * flow * (t(x, at, zeta) - 300) -
             k * m.width(i) / l * gap(x, at) * (t(x, at + e, zeta) - t(x, at - e, zeta)) / (2 * e);
    };
    const auto across = [&](int face) {
      const double at = film.zeta(face), flow = face == 0 || face == l ? 0 : film.layer(face, i, j);
      return c * flow * (t(x, z, at) - 300) -
             k * m.width(i) * m.depth(j) / h * (t(x, z, at + e) - t(x, z, at - e)) / (2 * e);
    };
    film.flow.heat[film.cell(q, i, j)] = around(film.right(i)) - around(film.left(i)) + along(film.far(j)) -
                                         along(film.near(j)) + across(q + 1) - across(q);
    s.bush.temperature[film.node(i, j)] = t(x, z, 0);
    s.journal.temperature[film.node(i, j)] = t(x, z, 1);
  });
  for (int j = film.rows.begin(); !closed && j < film.rows.end(); ++j)
    for (int q = 0; q < l; ++q) s.entering.push_back(t(0, m.z(j), film.middle(q)));
  Energy energy(film.rows, film.flow, {c, k, order}, film.thickness, s);
  core::Vector found = film.temperature(300);
  const EnergySolve solved = energy.solve(found.get(), 1e-7);
  EXPECT_TRUE(solved.converged) << n << " around";
  const core::ReadArray temperature(found.get());
  double sums[2] = {0, 0};
  film.each([&](int q, int i, int j) {
    const double volume = m.width(i) * m.depth(j) * gap(film.x(i), m.z(j));
    sums[0] += volume * std::abs(temperature[film.rows.cell(q, i, j)] - t(film.x(i), m.z(j), film.middle(q)));
    sums[1] += volume;
  });
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return sums[0] / sums[1];
}

TEST(Energy, SmoothTemperatureIsOfTheOrderOfTheScheme) {
  for (const int order : {1, 2})
    for (const bool closed : {true, false}) {
      if (order == 1 && !closed) continue;
      const double coarse = manufactured(8, order, closed), fine = manufactured(16, order, closed);
      EXPECT_GT(fine, 1e-9);
      EXPECT_GT(std::log2(coarse / fine), order - 0.1) << coarse << ' ' << fine << " closed " << closed;
    }
}

}  // namespace
}  // namespace whirl::thermal
