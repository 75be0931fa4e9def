// The compliant film of finite length: manufactured pressures, grooves, limits of short and long bearings.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "film/compliant_cases.hpp"

namespace whirl::film::testing {
namespace {

// P = Q (cos(theta - a) + 0.3) cos(pi z/L) on prescribed thickness and rates: residual and force of second order, on
// meshes that are not square. A damped rubber is deflected by 0.7 b P and takes the rest from its rate.
TEST(CompliantFinite, ManufacturedPressureAtSecondOrder) {
  constexpr double pi = std::numbers::pi, b = 0.4 / 300.0, Q = 250.0, a = 3.9, tilt = 0.3, ex = 0.25, ey = -0.35;
  const Geometry g = cylinder();
  const double c = g.clearance, k = std::pow(g.radius / g.length, 2),
               scale = 3.0 * oil().viscosity * g.length * 2.0 * g.radius * std::pow(g.radius / c, 2);
  std::array<double, 2> exact{};
  constexpr int fine = 200000;
  for (int i = 0; i < fine; ++i) {
    const double theta = 2.0 * pi * i / fine, p = 2.0 / pi * Q * std::max(std::cos(theta - a) + tilt, 0.0);
    exact[0] -= scale * p * std::cos(theta) * 2.0 * pi / fine;
    exact[1] -= scale * p * std::sin(theta) * 2.0 * pi / fine;
  }
  enum class Way { plain, as_source, third_order, damped_rubber };
  for (const Way way : {Way::plain, Way::as_source, Way::third_order, Way::damped_rubber}) {
    const bool as_source = way == Way::as_source, damped = way == Way::damped_rubber;
    const double soft = damped ? 0.7 * b : b, tau = 0.4 / kSpeed, rubber = 2.0, vx = 0.05, vy = -0.08;
    std::array<double, 3> residual{}, force{};
    for (std::size_t level = 0; level < 3; ++level) {
      Elastic o = compliant(Kind::compliant_finite, 0.4, 40 << level, as_source);
      o.cells[1] = 14 << level;
      if (way == Way::third_order) o.differences = Compliant::Differences::third_order;
      if (damped) {
        o.liner_damping = tau;
        o.rubber_thickness = rubber * c;
      }
      auto film = make_film(g, o, oil());
      std::vector<double> states, rates, exact_residual;
      for (int i = 0; i < o.cells[0]; ++i)
        for (int j = 1; j < o.cells[1]; ++j) {
          const double theta = 0.5 * pi + 2.0 * pi * i / o.cells[0],
                       z = pi * (static_cast<double>(j) / o.cells[1] - 0.5);
          const double f = std::cos(theta - a) + tilt, ft = -std::sin(theta - a);
          const double p = Q * f * std::cos(z), pt = Q * ft * std::cos(z), ptt = Q * (tilt - f) * std::cos(z);
          const double pz = -pi * Q * f * std::sin(z), pzz = -pi * pi * p;
          const double h = 1.0 - ex * std::cos(theta) - ey * std::sin(theta) + soft * p;
          const double ht = ex * std::sin(theta) - ey * std::cos(theta) + soft * pt, hz = soft * pz;
          const double flow = 0.5 * (3.0 * h * h * ht * pt + h * h * h * ptt +
                                     k * (3.0 * h * h * hz * pz + h * h * h * pzz) - kSpeed * ht);
          const double left = 1.0 - soft * std::abs(p) / rubber,
                       elastic = damped ? std::copysign(rubber / 3.0 * (1.0 / (left * left) - left), p) : soft * p;
          const double rate =
              damped ? (b * p - elastic) / tau - kSpeed * (vx * std::cos(theta) + vy * std::sin(theta)) : flow;
          states.push_back(c * h);
          rates.push_back(c * rate);
          exact_residual.push_back(c * (rate - flow));
        }
      StateResponse r;
      film->evaluate(motion(g, {ex, ey, 0.0, 0.0}, {vx, vy, 0.0, 0.0}, kSpeed), states, rates, Need::force, r);
      for (std::size_t n = 0; n < r.residual.size(); ++n)
        residual[level] += std::pow((r.residual[n] - exact_residual[n]) / c, 2);
      residual[level] = std::sqrt(residual[level] / static_cast<double>(r.residual.size()));
      force[level] = std::hypot(r.journal.force[0] - exact[0], r.journal.force[1] - exact[1]);
    }
    EXPECT_GT(residual[2], 0.0);
    EXPECT_LT(residual[2], 0.01 * kSpeed);
    EXPECT_LT(force[2], 2e-3 * std::hypot(exact[0], exact[1]));
    for (std::size_t level = 0; level < 2; ++level) {
      EXPECT_GE(std::log2(residual[level] / residual[level + 1]), 1.9);
      if (!as_source) {  // Simpson's nodal rule has kinks
        EXPECT_GE(std::log2(force[level] / force[level + 1]), 1.9);
      }
    }
  }
}

// L/D to 0: the short film, with a difference of order (L/D)^2. L/D to infinity: the periodic long film, of order D/L.
TEST(CompliantFinite, ShortAndLongLimits) {
  using enum Kind;
  const auto away = [](double length_to_diameter, const Options& rigid, std::array<int, 2> cells, double compliance) {
    Geometry g = cylinder();
    g.length = 2.0 * g.radius * length_to_diameter;
    Elastic o = compliant(compliant_finite, compliance, cells[0], false);
    o.cells = cells;
    auto film = make_film(g, o, oil());
    const JournalMotion m = motion(g, {0.3, -0.3, 0.0, 0.0}, {}, kSpeed);
    StateResponse r;
    const auto s = relaxed(*film, m);
    film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::force, r);
    const Response exact = evaluate(*make_film(g, rigid, oil()), m);
    return std::hypot(r.journal.force[0] - exact.force[0], r.journal.force[1] - exact.force[1]) /
           std::hypot(exact.force[0], exact.force[1]);
  };
  const Short thin;
  const Long wide;
  const double a = away(0.3, thin, {120, 24}, 0.1), b = away(0.15, thin, {120, 24}, 0.1);
  EXPECT_LT(b, 0.03);
  EXPECT_NEAR(std::log2(a / b), 2.0, 0.4);
  const double c = away(8.0, wide, {48, 60}, 1e-3), d = away(16.0, wide, {48, 120}, 1e-3);
  EXPECT_LT(d, 0.06);
  EXPECT_NEAR(std::log2(c / d), 1.0, 0.2);
}

}  // namespace
}  // namespace whirl::film::testing
