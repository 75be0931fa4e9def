// Films in closed form: van de Vrande (2001) chapter 4 and appendix B with the errata, and quadrature of the
// definitions.
#include "whirl/film/impedance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "film/cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

using K = Options::Kind;
using Matrix = std::array<Pair, 2>;
constexpr double pi = std::numbers::pi;
constexpr K kAll[] = {K::short_bearing, K::long_bearing, K::long_inlet, K::finite_approximate};

struct State {
  Pair e, v;
};
State random_state(std::mt19937& g, double limit) {
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const double eps = limit * std::sqrt(u(g)), t = 2 * pi * u(g), s = 0.1 + u(g), b = 2 * pi * u(g);
  return {{eps * std::cos(t), eps * std::sin(t)}, {s * std::cos(b), s * std::sin(b)}};
}
Pair turned(const Pair& a, double angle) {
  return {std::cos(angle) * a[0] - std::sin(angle) * a[1], std::sin(angle) * a[0] + std::cos(angle) * a[1]};
}

// Five-point Gauss rule on 400 panels.
double integral(double from, double to, const std::function<double(double)>& f) {
  const double x[] = {0.0, std::sqrt(5 - 2 * std::sqrt(10.0 / 7)) / 3, std::sqrt(5 + 2 * std::sqrt(10.0 / 7)) / 3};
  const double w[] = {128.0 / 225, (322 + 13 * std::sqrt(70.0)) / 900, (322 - 13 * std::sqrt(70.0)) / 900};
  constexpr int kPanels = 400;
  double sum = 0;
  for (int i = 0; i < kPanels; ++i) {
    const double half = 0.5 * (to - from) / kPanels, middle = from + (2 * i + 1) * half;
    sum += half * w[0] * f(middle);
    for (int k = 1; k < 3; ++k) sum += half * w[k] * (f(middle + half * x[k]) + f(middle - half * x[k]));
  }
  return sum;
}

// F* = -3 int p* (cos, sin), over the interval where p* is positive.
Pair by_quadrature(const std::function<double(double)>& p, double from, double to) {
  return {-3 * integral(from, to, [&](double t) { return p(t) * std::cos(t); }),
          -3 * integral(from, to, [&](double t) { return p(t) * std::sin(t); })};
}

double thickness(const Pair& e, double t) {
  return 1 - e[0] * std::cos(t) - e[1] * std::sin(t);
}

// (4.15) in the angle phi from the greatest thickness, theta = phi + angle of e + pi.
double long_pressure(const State& s, double theta) {
  const double eps = std::hypot(s.e[0], s.e[1]), at = std::atan2(s.e[1], s.e[0]), v = std::hypot(s.v[0], s.v[1]);
  const double alpha = at - std::atan2(s.v[1], s.v[0]), phi = theta - at - pi, b = 2 / (2 + eps * eps);
  return -v * (std::cos(alpha) * std::cos(phi) - b * std::sin(alpha) * std::sin(phi)) * (2 + eps * std::cos(phi)) /
         std::pow(1 + eps * std::cos(phi), 2);
}
double long_start(const State& s) {  // (4.15) f.: positive from phi_1 over pi
  const double eps = std::hypot(s.e[0], s.e[1]), at = std::atan2(s.e[1], s.e[0]);
  const double alpha = at - std::atan2(s.v[1], s.v[0]);
  return at + pi + 0.5 * pi - alpha +
         std::atan(eps * eps * std::sin(2 * alpha) / (4 + eps * eps * (1 + std::cos(2 * alpha))));
}

void expect_near(const Pair& a, const Pair& b, double relative) {
  const double size = std::hypot(b[0], b[1]);
  EXPECT_NEAR(a[0], b[0], relative * size);
  EXPECT_NEAR(a[1], b[1], relative * size);
}

}  // namespace

TEST(Impedance, ShortFilmIsItsIntegral) {  // (4.10)
  std::mt19937 g(1);
  for (int n = 0; n < 300; ++n) {
    const State s = random_state(g, 0.97);
    const double ld = 0.7, beta = std::atan2(s.v[1], s.v[0]);
    const auto p = [&](double t) {
      return 2.0 / 3 * ld * ld * (s.v[0] * std::cos(t) + s.v[1] * std::sin(t)) / std::pow(thickness(s.e, t), 3);
    };
    expect_near(impedance(K::short_bearing, ld, s.e, s.v).force, by_quadrature(p, beta - pi / 2, beta + pi / 2), 1e-12);
  }
}

TEST(Impedance, LongFilmIsItsIntegral) {  // (4.15)
  std::mt19937 g(2);
  for (int n = 0; n < 300; ++n) {
    const State s = random_state(g, 0.97);
    const double from = long_start(s);
    const auto p = [&](double t) { return long_pressure(s, t); };
    expect_near(impedance(K::long_bearing, 0.7, s.e, s.v).force, by_quadrature(p, from, from + pi), 1e-12);
  }
}

TEST(Impedance,
     LongFilmWithInletIsItsIntegral) {  // (4.42) in the form of errata B10: periodic pressure less that at 90 deg
  std::mt19937 g(3);
  for (int n = 0; n < 200; ++n) {
    const State s = random_state(g, 0.9);
    const double top = pi / 2, level = long_pressure(s, top);
    const auto p = [&](double t) { return long_pressure(s, t) - level; };
    // The other root, bisected from the end of the circle where the sign differs from that just after the inlet.
    const double sign = p(top + 1e-4) > 0 ? 1 : -1;
    double from = top + 1e-4, to = top + 2 * pi - 1e-4;
    if (p(to) * sign > 0) continue;  // the inlet lies within 1e-4 of an extreme
    for (int k = 0; k < 100; ++k) (p(0.5 * (from + to)) * sign > 0 ? from : to) = 0.5 * (from + to);
    const Pair force = sign > 0 ? by_quadrature(p, top, from) : by_quadrature(p, from, top + 2 * pi);
    const Impedance f = impedance(K::long_inlet, 0.7, s.e, s.v);
    const double size = std::hypot(f.d_squeeze[0][0], f.d_squeeze[1][1]) * std::hypot(s.v[0], s.v[1]);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(f.force[i], force[i], 1e-11 * size);
  }
}

TEST(Impedance, FiniteFilmIsTheHarmonicSumOfComponents) {  // (4.17)
  std::mt19937 g(4);
  int compared = 0;
  for (int n = 0; n < 300; ++n) {
    const State s = random_state(g, 0.95);
    const double eps = std::hypot(s.e[0], s.e[1]);
    const Pair a = impedance(K::short_bearing, 1.3, s.e, s.v).force,
               b = impedance(K::long_bearing, 1.3, s.e, s.v).force,
               f = impedance(K::finite_approximate, 1.3, s.e, s.v).force;
    for (const Pair& u : {Pair{s.e[0] / eps, s.e[1] / eps}, Pair{-s.e[1] / eps, s.e[0] / eps}}) {
      const double x = a[0] * u[0] + a[1] * u[1], y = b[0] * u[0] + b[1] * u[1], z = f[0] * u[0] + f[1] * u[1];
      EXPECT_LE(std::abs(z), std::min(std::abs(x), std::abs(y)) * (1 + 1e-12));
      if (x * y <= 0) continue;
      ++compared;
      EXPECT_NEAR(1 / z, 1 / x + 1 / y, 1e-12 * std::abs(1 / z));
    }
  }
  EXPECT_GT(compared, 500);
}

TEST(Impedance, DerivativesAreConsistent) {
  std::mt19937 g(5);
  for (const K kind : kAll)
    for (int n = 0; n < 200; ++n) {
      const State s = random_state(g, 0.85);
      const Impedance at = impedance(kind, 0.9, s.e, s.v);
      // Euler's theorem for degree one.
      expect_near({at.d_squeeze[0][0] * s.v[0] + at.d_squeeze[0][1] * s.v[1],
                   at.d_squeeze[1][0] * s.v[0] + at.d_squeeze[1][1] * s.v[1]},
                  at.force, 1e-11);
      for (std::size_t j = 0; j < 2; ++j)
        for (const bool velocity : {false, true}) {
          const auto moved = [&](double step) {
            State m = s;
            (velocity ? m.v : m.e)[j] += step;
            return impedance(kind, 0.9, m.e, m.v).force;
          };
          const double h = kind == K::finite_approximate ? 1e-5 : 1e-4;  // curvature jumps
          const Pair a = moved(h), b = moved(-h), c = moved(2 * h), d = moved(-2 * h);
          const Matrix& slope = velocity ? at.d_squeeze : at.d_eccentricity;
          const double size = std::hypot(at.d_squeeze[0][0], at.d_squeeze[1][1]) +
                              std::hypot(at.d_eccentricity[0][0], at.d_eccentricity[1][1]);
          for (std::size_t i = 0; i < 2; ++i) {
            const double quotient = (8 * (a[i] - b[i]) - (c[i] - d[i])) / (12 * h);
            EXPECT_NEAR(slope[i][j], quotient, 1e-6 * size) << static_cast<int>(kind) << " state " << n;
          }
        }
    }
}

TEST(Impedance, TurnsWithTheFrame) {
  std::mt19937 g(6);
  for (const K kind : {K::short_bearing, K::long_bearing, K::finite_approximate})
    for (int n = 0; n < 50; ++n) {
      const State s = random_state(g, 0.95);
      const double angle = 0.1 + n;
      const Pair there = impedance(kind, 0.9, turned(s.e, angle), turned(s.v, angle)).force;
      expect_near(there, turned(impedance(kind, 0.9, s.e, s.v).force, angle), 1e-11);
    }
}

// With the inlet where the periodic pressure vanishes, a journal pushed straight down by a rotating shaft without
// whirl, both long films are the same.
TEST(Impedance, InletAtTheEdgeOfTheHalfFilm) {
  const Pair e = {0.0, -0.6}, v = {-0.3, 0.0};
  expect_near(impedance(K::long_inlet, 1, e, v).force, impedance(K::long_bearing, 1, e, v).force, 1e-13);
}

TEST(Impedance, IsRegularAtTheCentreAndAtRest) {
  for (const K kind : kAll) {
    const Impedance centre = impedance(kind, 1, {0, 0}, {0.3, -0.4});
    const double w = kind == K::short_bearing ? pi : kind == K::finite_approximate ? 0.75 * pi : 3 * pi;
    if (kind != K::long_inlet) {
      EXPECT_NEAR(centre.force[0], -0.3 * w, 1e-13);
      EXPECT_NEAR(centre.force[1], 0.4 * w, 1e-13);
    }
    const Impedance near = impedance(kind, 1, {1e-7, -2e-7}, {0.3, -0.4});
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(near.force[i], centre.force[i], 1e-5);
      for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_NEAR(near.d_squeeze[i][j], centre.d_squeeze[i][j], 1e-5);
        EXPECT_NEAR(near.d_eccentricity[i][j], centre.d_eccentricity[i][j], 1e-4);
      }
    }
    const Impedance rest = impedance(kind, 1, {0.3, -0.2}, {0, 0});
    const Impedance slow = impedance(kind, 1, {0.3, -0.2}, {-0.2e-9, -0.3e-9});
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(rest.force[i], 0);
      for (std::size_t j = 0; j < 2; ++j) EXPECT_NEAR(rest.d_squeeze[i][j], slow.d_squeeze[i][j], 1e-12);
    }
  }
}

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
  Options o;
  o.kind = kind;
  auto model = make_model(g, o, lubricant);
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

TEST(Impedance, MobilityIsTheInverse) {
  std::mt19937 g(7);
  for (const K kind : kAll)
    for (int n = 0; n < 100; ++n) {
      const State s = random_state(g, 0.95);
      const Pair force = impedance(kind, 0.8, s.e, s.v).force;
      if (std::hypot(force[0], force[1]) < 1e-3) continue;  // an inlet that leaves hardly any film
      const Pair v = squeeze_under(kind, 0.8, s.e, force);
      expect_near(impedance(kind, 0.8, s.e, v).force, force, 1e-10);
      if (kind == K::short_bearing || kind == K::long_bearing) expect_near(v, s.v, 1e-8);
    }
}

TEST(Impedance, EccentricityIsBelowOne) {
  for (const K kind : kAll) {
    EXPECT_THROW(impedance(kind, 1, {0.8, -0.61}, {1, 0}), core::DomainError);
    EXPECT_THROW(impedance(kind, 1, {std::nan(""), 0}, {1, 0}), core::DomainError);
    EXPECT_NO_THROW(impedance(kind, 1, {0.999, 0}, {1, 0}));
  }
}

// Report quantities: side flow and peak pressure of the short film, friction, and pressures that give the force.
TEST(Rigid, ReportQuantities) {
  const Geometry g = cylinder();
  const double speed = 300, eps = 0.5;
  for (const K kind : {K::short_bearing, K::long_bearing, K::long_inlet}) {
    Options o;
    o.kind = kind;
    auto model = make_model(g, o, oil());
    const Motion m = motion(g, {0.3, -0.4, 0, 0}, {0.1, -0.2, 0, 0}, speed);
    const Response r = evaluate(*model, m, Need::force);
    const auto fields = model->fields(m);
    ASSERT_EQ(fields.size(), 4U);
    const std::size_t rows = fields[0].values.size(), columns = fields[1].values.size();
    double fx = 0, fy = 0, peak = 0;
    for (std::size_t i = 0; i + 1 < rows; ++i)
      for (std::size_t j = 0; j < columns; ++j) {
        const double simpson = columns == 2 ? 0.5 : j == 0 || j + 1 == columns ? 1.0 / 48 : j % 2 ? 4.0 / 48 : 2.0 / 48;
        const double p = fields[2].values[i * columns + j], area = g.radius * 2 * pi / 180 * g.length * simpson;
        fx -= p * area * std::cos(fields[0].values[i]);
        fy -= p * area * std::sin(fields[0].values[i]);
        peak = std::max(peak, p);
      }
    expect_near({fx, fy}, {r.force[0], r.force[1]}, 1e-3);
    const Summary s = model->summary(m);
    EXPECT_NEAR(s.max_pressure, peak, 1e-3 * peak);
    EXPECT_GE(s.max_pressure, peak);
    EXPECT_NEAR(s.min_thickness, 0.5 * g.clearance, 1e-12);
    const Motion still = motion(g, {0.3, -0.4, 0, 0}, {}, speed);
    const Response at = evaluate(*model, still, Need::force);
    const Summary t = model->summary(still);
    const double flow = kind == K::short_bearing ? eps * speed * g.radius * g.clearance * g.length : 0;
    EXPECT_NEAR(t.side_flow, flow, 1e-12 * (flow + 1e-12));
    const double U = speed * g.radius, arm = 0.3 * g.clearance * at.force[1] + 0.4 * g.clearance * at.force[0];
    const double petroff = 2 * pi * oil().viscosity * U * g.radius * g.length / (g.clearance * std::sqrt(0.75));
    EXPECT_NEAR(t.power_loss, U * (petroff + arm / (2 * g.radius)), 1e-10 * t.power_loss);
  }
}

TEST(Rigid, NeedsACylindricalBore) {
  for (const K kind : kAll) {
    Options o;
    o.kind = kind;
    EXPECT_THROW(make_model(arc(), o, oil()), core::InputError);
    EXPECT_THROW(make_model(cylinder(), o, {0, 0}), core::InputError);
  }
  EXPECT_THROW(make_model(cylinder(), {}, oil()), core::InputError);
}

}  // namespace whirl::film::testing
