// Liners that are damped and stiffen: against a mesh-free computation of the short film, and in their limits.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "film/compliant_cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

using Complex = std::complex<double>;

constexpr double kTau = 0.6 / kSpeed, kRubber = 0.6, kB = 0.3 / 300.0;  // s; thickness in clearances; b [s]
constexpr double ex = 0.35, ey = -0.45;

Elastic soft(Kind kind, int cells) {
  Elastic o = compliant(kind, 0.3, cells, false);
  o.liner_damping = kTau;
  o.rubber_thickness = kRubber * cylinder().clearance;
  return o;
}

// (4.27) around the bearing by the classical Runge-Kutta scheme, h the thickness at rest and y its change at frequency
// w by a unit motion of the journal in x and y:
//
//     Omega/2 h' = -a h^3 P,   i w y + Omega/2 y' = -a (3 h^2 y P + h^3 Q),   Q = (phi' + i w tau)/b (y + (cos, sin))
//
// both stable in the direction of rotation, so that some turns give the periodic solution. a = 1.5/(L/D)^2.
struct MeshFree {
  std::array<double, 2> force{};
  std::array<Complex, 4> stiffness{};  // K + i w C: xx, xy, yx, yy
};

MeshFree mesh_free(double w) {
  const Geometry g = cylinder();
  const double a = 1.5 * std::pow(2.0 * g.radius / g.length, 2), c = g.clearance,
               scale = 6.0 * oil().viscosity * std::pow(g.radius / c, 2) * g.length * g.radius;
  struct Point {
    double h;
    std::array<Complex, 2> y;
  };
  struct Law {
    double pressure, slope;
  };
  const auto law = [&](double u) {
    const double left = 1.0 - u / kRubber;
    return Law{kRubber / 3.0 * (1.0 / (left * left) - left) / kB, (2.0 / (left * left * left) + 1.0) / 3.0 / kB};
  };
  const auto deflection = [](double theta, double h) { return h - 1.0 + ex * std::cos(theta) + ey * std::sin(theta); };
  const auto carried = [&](double theta, const Point& x) {
    const Law l = law(deflection(theta, x.h));
    const Complex by = l.slope + Complex(0.0, w * kTau / kB);
    return std::array{by * (x.y[0] + std::cos(theta)), by * (x.y[1] + std::sin(theta))};
  };
  const auto slope = [&](double theta, const Point& x) {
    const double p = law(deflection(theta, x.h)).pressure, f = 2.0 / kSpeed, h2 = x.h * x.h;
    const auto q = carried(theta, x);
    Point d{-f * a * h2 * x.h * p, {}};
    for (std::size_t j = 0; j < 2; ++j)
      d.y[j] = -f * (Complex(0.0, w) * x.y[j] + a * (3.0 * h2 * x.y[j] * p + h2 * x.h * q[j]));
    return d;
  };
  const auto moved = [](const Point& x, double s, const Point& d) {
    return Point{x.h + s * d.h, {x.y[0] + s * d.y[0], x.y[1] + s * d.y[1]}};
  };
  constexpr int steps = 20000, turns = 4;
  const double step = 2.0 * std::numbers::pi / steps;
  Point x{1.0, {}};
  MeshFree out;
  for (int k = 0; k < turns * steps; ++k) {
    const double theta = step * k;
    if (k >= (turns - 1) * steps) {
      const double p = law(deflection(theta, x.h)).pressure;
      const auto q = carried(theta, x);
      const std::array<double, 2> n = {std::cos(theta), std::sin(theta)};
      for (std::size_t i = 0; i < 2 && p > 0.0; ++i) {
        out.force[i] -= scale * p * n[i] * step;
        for (std::size_t j = 0; j < 2; ++j) out.stiffness[2 * i + j] += scale / c * q[j] * n[i] * step;
      }
    }
    const Point k1 = slope(theta, x), k2 = slope(theta + 0.5 * step, moved(x, 0.5 * step, k1)),
                k3 = slope(theta + 0.5 * step, moved(x, 0.5 * step, k2)), k4 = slope(theta + step, moved(x, step, k3));
    for (const auto& [d, weight] : {std::pair{k1, 1.0}, std::pair{k2, 2.0}, std::pair{k3, 2.0}, std::pair{k4, 1.0}})
      x = moved(x, weight * step / 6.0, d);
  }
  return out;
}

TEST(Liner, ForceStiffnessAndDampingOfAShortFilmAgainstOneWithoutMesh) {
  const JournalMotion m = still(ex, ey);
  for (const double ratio : {0.3, 1.0, 5.0}) {
    const double w = ratio * kSpeed;
    const MeshFree exact = mesh_free(w);
    double size = 0.0;
    for (const Complex& k : exact.stiffness) size = std::max(size, std::abs(k));
    const double load = std::hypot(exact.force[0], exact.force[1]);
    std::array<double, 2> error{}, of_force{};
    for (std::size_t level = 0; level < 2; ++level) {
      auto film = make_film(cylinder(), soft(Kind::compliant_short, 100 << level), oil());
      const auto s = relaxed(*film, m);
      StateResponse r;
      film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::force, r);
      of_force[level] = std::hypot(r.journal.force[0] - exact.force[0], r.journal.force[1] - exact.force[1]) / load;
      const Coefficients k = coefficients(*film, m, s, w);
      for (std::size_t e = 0; e < 4; ++e)
        error[level] += std::abs(Complex(k.stiffness[e], w * k.damping[e]) - exact.stiffness[e]) / size;
    }
    EXPECT_LT(of_force[1], 5e-4);
    EXPECT_GT(std::log2(of_force[0] / of_force[1]), 1.7);
    EXPECT_LT(error[1], 4e-3) << ratio;
    EXPECT_GT(std::log2(error[0] / error[1]), 1.6) << ratio;
  }
}

// Far above the rates of the film the thickness stays and the liner alone gives way: K is its spring, C = tau K.
TEST(Liner, FastVibrationsSeeTheLinerAlone) {
  for (const auto kind : {Kind::compliant_short, Kind::compliant_finite}) {
    Elastic o = soft(kind, 24);
    o.rubber_thickness.reset();
    auto damped = make_film(cylinder(), o, oil());
    o.liner_damping = 0.0;
    auto plain = make_film(cylinder(), o, oil());
    const JournalMotion m = still(ex, ey);
    const auto s = relaxed(*damped, m);
    const Coefficients a = coefficients(*plain, m, s, 1e7 * kSpeed);
    StateResponse r;
    plain->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::tangents, r);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_NEAR(a.stiffness[2 * i + j], -r.journal.d_position[i][j], 1e-5 * std::abs(r.journal.d_position[0][0]));
        damped->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::tangents, r);
        EXPECT_NEAR(r.journal.d_velocity[i][j], kTau * r.journal.d_position[i][j],
                    1e-12 * std::abs(r.journal.d_velocity[0][0]));
      }
  }
}

// Damping leaves a film at rest alone, and pressures are those of the film and not of the liner's spring.
TEST(Liner, DampingDoesNotMoveAFilmAtRest) {
  using enum Kind;
  for (const auto kind : {compliant_short, compliant_long, compliant_finite}) {
    Elastic o = soft(kind, 24);
    auto damped = make_film(cylinder(), o, oil());
    o.liner_damping = 0.0;
    auto plain = make_film(cylinder(), o, oil());
    const JournalMotion m = still(ex, ey);
    const auto a = relaxed(*damped, m), b = relaxed(*plain, m);
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-9 * scale_of(*damped));
    EXPECT_NEAR(damped->summary(m, a).max_pressure, plain->summary(m, b).max_pressure,
                1e-8 * plain->summary(m, b).max_pressure);
    // A journal that moves: the balanced rates satisfy the equation and carry another pressure than the spring.
    const JournalMotion moving = motion(cylinder(), {ex, ey, 0.0, 0.0}, {0.1, -0.1, 0.0, 0.0}, kSpeed);
    EXPECT_GT(std::abs(damped->summary(moving, a).max_pressure / plain->summary(moving, b).max_pressure - 1.0), 1e-3);
    EXPECT_FALSE(damped->constant_rates());
    EXPECT_TRUE(plain->constant_rates());
  }
}

TEST(Liner, RubberStiffensAndHasAnEnd) {
  using enum Kind;
  const JournalMotion m = still(0.3, -0.6);
  for (const auto kind : {compliant_short, compliant_finite}) {
    double last = 1e300;
    for (const double thickness : {0.5, 1.0, 2.0, 1e6}) {  // clearances
      Elastic o = compliant(kind, 0.3, 60, false);
      o.rubber_thickness = thickness * cylinder().clearance;
      const Response r = static_response(o, m);
      const double force = std::hypot(r.force[0], r.force[1]);
      EXPECT_LT(force, last);
      last = force;
    }
    const Response linear = static_response(compliant(kind, 0.3, 60, false), m);
    EXPECT_NEAR(last, std::hypot(linear.force[0], linear.force[1]), 1e-5 * last);
    Elastic thin = compliant(kind, 0.3, 60, false);
    thin.rubber_thickness = 0.5 * cylinder().clearance;
    auto film = make_film(cylinder(), thin, oil());
    std::vector<double> s(film->states());
    film->unloaded(m, s);
    s[3] += 0.501 * cylinder().clearance;
    StateResponse r;
    EXPECT_THROW(film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::force, r), core::DomainError);
  }
  Elastic wrong = compliant(compliant_short, 0.3, 60, false);
  wrong.liner_damping = -1.0;
  EXPECT_THROW(make_film(cylinder(), wrong, oil()), core::InputError);
}

}  // namespace
}  // namespace whirl::film::testing
