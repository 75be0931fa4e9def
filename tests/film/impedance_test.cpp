// Films in closed form: van de Vrande (2001) section 4.1 with the errata, and quadrature of the definitions.
#include "film/closed/impedance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "film/cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

using K = ClosedForm;
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
    const Options o = film_of(kind);
    auto model = make_film(g, o, oil());
    const JournalMotion m = motion(g, {0.3, -0.4, 0, 0}, {0.1, -0.2, 0, 0}, speed);
    const Response r = evaluate(*model, m, Need::force);
    const auto fields = model->fields(m, {});
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
    const FilmReport s = model->summary(m, {});
    EXPECT_NEAR(s.max_pressure, peak, 1e-3 * peak);
    EXPECT_GE(s.max_pressure, peak);
    EXPECT_NEAR(s.min_thickness, 0.5 * g.clearance, 1e-12);
    const JournalMotion still = motion(g, {0.3, -0.4, 0, 0}, {}, speed);
    const Response at = evaluate(*model, still, Need::force);
    const FilmReport t = model->summary(still, {});
    const double flow = kind == K::short_bearing ? eps * speed * g.radius * g.clearance * g.length : 0;
    EXPECT_NEAR(t.side_flow, flow, 1e-12 * (flow + 1e-12));
    const double U = speed * g.radius, arm = 0.3 * g.clearance * at.force[1] + 0.4 * g.clearance * at.force[0];
    const double petroff = 2 * pi * oil().viscosity * U * g.radius * g.length / (g.clearance * std::sqrt(0.75));
    EXPECT_NEAR(t.power_loss, U * (petroff + arm / (2 * g.radius)), 1e-10 * t.power_loss);
  }
}

TEST(Rigid, NeedsACylindricalBore) {
  for (const K kind : kAll) {
    const Options o = film_of(kind);
    EXPECT_THROW(make_film(arc(), o, oil()), core::InputError);
    EXPECT_THROW(make_film(cylinder(), o, {0, 0}), core::InputError);
  }
}

}  // namespace whirl::film::testing
