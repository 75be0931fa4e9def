// Films in closed form about an equilibrium: van de Vrande (2001) section 4.3 and appendix B with the errata.
#include <gtest/gtest.h>

#include <cmath>

#include "film/cases.hpp"
#include "film/closed/impedance.hpp"

namespace whirl::film::testing {
namespace {

using K = ClosedForm;
constexpr double pi = std::numbers::pi;

}  // namespace

// (4.33)-(4.35), their counterparts of the long film and errata B12, at alpha = 90 deg: e along x, v along -y.
TEST(Impedance, AtEquilibrium) {
  for (const double e : {0.01, 0.112974, 0.4, 0.8, 0.95})
    for (const double ld : {0.4, 1.0, 1.7}) {
      const double q = 1 - e * e, L2 = ld * ld, s = 2 + e * e;
      const double sA = 2 * L2 + 3 + (L2 - 3) * e * e, sB = 2 * (L2 + 3) + (L2 - 6) * e * e;
      struct Row {
        K kind;
        double W_eps, W_gam, eps_e, gam_e, eps_alpha, gam_alpha;
      };
      const Row rows[] = {
          {K::short_bearing, 4 * e / (q * q) * L2, -pi / std::pow(q, 1.5) * L2, 4 * (1 + 3 * e * e) / (q * q * q) * L2,
           -3 * pi * e / std::pow(q, 2.5) * L2, -pi * (1 + 2 * e * e) / std::pow(q, 2.5) * L2, 4 * e / (q * q) * L2},
          {K::long_bearing, 12 * e / (s * q), -6 * pi / (s * std::sqrt(q)),
           12 * (2 + e * e + 3 * std::pow(e, 4)) / (s * s * q * q),
           -18 * pi * std::pow(e, 3) / (s * s * std::pow(q, 1.5)), -3 * pi / std::pow(q, 1.5), 6 * e / q},
          {K::finite_approximate, 12 * L2 * e / (sA * q), -6 * pi * L2 / (sB * std::sqrt(q)),
           12 * L2 * (2 * L2 + 3 + (L2 + 6) * e * e + 3 * (L2 - 3) * std::pow(e, 4)) / (sA * sA * q * q),
           -18 * pi * L2 * e * (6 + (L2 - 6) * e * e) / (sB * sB * std::pow(q, 1.5)),
           -3 * pi * L2 * ((4 * L2 + 3) * (1 + e * e) + (L2 - 6) * std::pow(e, 4)) / (sA * sA * std::pow(q, 1.5)),
           6 * L2 * e * (4 * (L2 + 6) + 4 * (L2 - 6) * e * e + L2 * std::pow(e, 4)) / (sB * sB * q)}};
      for (const Row& row : rows) {
        const double v = 0.5 * e;
        const Impedance f = impedance(row.kind, ld, {e, 0}, {0, -v});
        const auto near = [&](double value, double reference) {
          EXPECT_NEAR(value, reference, 1e-12 * std::max(std::abs(reference), std::abs(row.eps_alpha)));
        };
        near(-f.force[0] / v, row.W_eps);
        near(-f.force[1] / v, row.W_gam);
        near(-f.d_eccentricity[0][0] / v, row.eps_e);
        near(-f.d_eccentricity[1][0] / v, row.gam_e);
        // Along v the force grows with |v|; turning v by beta lowers alpha by beta, a step of |v| beta along +x.
        near(f.d_squeeze[0][1], row.W_eps);
        near(f.d_squeeze[1][1], row.W_gam);
        near(f.d_squeeze[0][0], row.eps_alpha);
        near(f.d_squeeze[1][0], row.gam_alpha);
      }
    }
}

namespace {

// K*, B* of a bearing under a load in -y at Omega* = 1, and its Sommerfeld number, from the model in SI.
struct Coefficients {
  double S, attitude;
  double k[2][2], b[2][2];
};
Coefficients coefficients(K kind, double ld, double eps) {
  const Geometry g{Geometry::Bore::cylindrical, 0.05, 0.1 * ld, 0.0001, 0, 0, 0};
  const Lubricant lubricant{0.02, 0};
  const Options o = film_of(kind);
  auto model = make_film(g, o, lubricant);
  const double speed = 200, unit = lubricant.viscosity * g.length * 2 * g.radius * std::pow(g.radius / g.clearance, 2);
  const Response flat = evaluate(*model, motion(g, {0, -eps, 0, 0}, {}, speed));
  Coefficients c{};
  c.attitude = std::atan2(flat.force[0], flat.force[1]);
  const Response r =
      evaluate(*model, motion(g, {eps * std::sin(c.attitude), -eps * std::cos(c.attitude), 0, 0}, {}, speed));
  c.S = r.force[1] / (unit * speed);
  EXPECT_NEAR(r.force[0] / (unit * speed), 0, 1e-13 * c.S);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      c.k[i][j] = -r.d_position[i][j] * g.clearance / (unit * speed);
      c.b[i][j] = -r.d_velocity[i][j] * g.clearance / unit;
    }
  return c;
}

}  // namespace

TEST(Impedance, StiffnessAndDampingOfAppendixB) {
  for (const double e : {0.01, 0.1, 0.3, 0.6, 0.9, 0.98}) {
    const double e2 = e * e, e4 = e2 * e2, q = 1 - e2, p2 = pi * pi, s = 2 + e2;
    for (const double ld : {0.5, 1.0}) {
      const double L2 = ld * ld, n = 16 * e2 + p2 * q;
      const Coefficients c = coefficients(K::short_bearing, ld, e);
      EXPECT_NEAR(c.S, e * std::sqrt(n) / (2 * q * q) * L2, 1e-12 * c.S);
      EXPECT_NEAR(c.attitude, std::atan(pi * std::sqrt(q) / (4 * e)), 1e-12);
      const double shear = pi * (32 * e2 * (1 + e2) + p2 * q * (1 + 2 * e2)) / (2 * std::pow(q, 2.5) * n) * L2;
      const double direct = p2 * (1 + 2 * e2) - 16 * e2;
      const double k[2][2] = {{2 * e * (16 * e2 + p2 * (2 - e2)) / (q * q * n) * L2,
                               -pi * (16 * e4 - p2 * q * q) / (2 * std::pow(q, 2.5) * n) * L2},
                              {-shear, 4 * e / (pi * std::sqrt(q)) * shear}};
      const double b[2][2] = {
          {pi * direct / (std::pow(q, 1.5) * n) * L2, -4 * e * direct / (q * q * n) * L2},
          {-4 * e * direct / (q * q * n) * L2, pi * (48 * e2 + p2 * q * q) / (std::pow(q, 2.5) * n) * L2}};
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
          EXPECT_NEAR(c.k[i][j], k[i][j], 1e-12 * std::abs(k[1][0])) << i << j;
          EXPECT_NEAR(c.b[i][j], b[i][j], 1e-12 * std::abs(b[1][1])) << i << j;
        }
    }
    const double n = 4 * e2 + p2 * q;
    const Coefficients c = coefficients(K::long_bearing, 1, e);
    EXPECT_NEAR(c.S, 3 * e * std::sqrt(n) / (s * q), 1e-12 * c.S);
    EXPECT_NEAR(c.attitude, std::atan(pi * std::sqrt(q) / (2 * e)), 1e-12);
    const double shear = 8 * e2 * (2 + e4) + p2 * q * (2 - e2 + 2 * e4);
    const double k[2][2] = {
        {6 * e * (4 * e2 + p2 * (2 - e2)) / (s * q * n), -3 * pi * (4 * e4 - p2 * q * q) / (s * std::pow(q, 1.5) * n)},
        {-3 * pi * shear / (s * s * std::pow(q, 1.5) * n), 6 * e * shear / (s * s * q * q * n)}};
    const double b[2][2] = {{3 * pi * (p2 - 4 * e2) / (std::sqrt(q) * n), -6 * e * (p2 - 4 * e2) / (q * n)},
                            {-6 * e * (p2 * (2 + 2 * e2 - e4) - 8 * e2) / (s * q * n),
                             6 * pi * (2 * e2 * (6 - 2 * e2 - e4) + p2 * q * q) / (s * std::pow(q, 1.5) * n)}};
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        EXPECT_NEAR(c.k[i][j], k[i][j], 1e-12 * std::abs(k[1][0])) << i << j;
        EXPECT_NEAR(c.b[i][j], b[i][j], 1e-12 * std::abs(b[1][1])) << i << j;
      }
  }
}

// Stability threshold of a rigid rotor of load F0* in two bearings by Routh's criterion, sec. 5.2: Omega* = F0*/(2 S).
TEST(Impedance, RouthThresholds) {
  const auto margin = [](K kind, double F0, double eps) {
    const Coefficients c = coefficients(kind, 1, eps);
    const auto &k = c.k, &b = c.b;
    const double a0 = (k[0][0] * k[1][1] - k[0][1] * k[1][0]) / (c.S * c.S);
    const double a1 = 2 * (k[0][0] * b[1][1] - k[0][1] * b[1][0] - k[1][0] * b[0][1] + k[1][1] * b[0][0]) / (c.S * F0);
    const double a2 = (k[0][0] + k[1][1]) / c.S + 4 * (b[0][0] * b[1][1] - b[0][1] * b[1][0]) / (F0 * F0);
    const double a3 = 2 * (b[0][0] + b[1][1]) / F0;
    return a1 * a2 * a3 - a0 * a3 * a3 - a1 * a1;
  };
  struct Row {
    K kind;
    double F0, speed, eps;
  };
  for (const Row& row : {Row{K::short_bearing, 0.5, 2.75634869, 0}, Row{K::short_bearing, 1, 2.73526314, 0.112974},
                         Row{K::short_bearing, 2, 2.67117718, 0}, Row{K::long_bearing, 2, 1.97398006, 0.10724},
                         Row{K::long_bearing, 1, 1.95939819, 0}}) {
    double stable = 0.6, unstable = 0.02;  // the lighter the load, the faster the rotor
    EXPECT_GT(margin(row.kind, row.F0, stable), 0);
    EXPECT_LT(margin(row.kind, row.F0, unstable), 0);
    for (int i = 0; i < 60; ++i)
      (margin(row.kind, row.F0, 0.5 * (stable + unstable)) > 0 ? stable : unstable) = 0.5 * (stable + unstable);
    EXPECT_NEAR(row.F0 / (2 * coefficients(row.kind, 1, stable).S), row.speed, 1e-8);
    if (row.eps > 0) {
      EXPECT_NEAR(stable, row.eps, 1e-5);
    }
  }
}

}  // namespace whirl::film::testing
