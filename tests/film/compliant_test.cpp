// Films with own states: derivatives, limits, orders of accuracy, coefficients.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "film/cases.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/state_model.hpp"

namespace whirl::film::testing {
namespace {

constexpr double kSpeed = 377.0;

Options compliant(Options::Kind kind, double compliance, int cells, bool as_source) {
  Options o;
  o.kind = kind;
  o.compliance = compliance;
  o.reference_speed = 300.0;
  o.cells = {cells, kind == Options::Kind::compliant_finite ? 8 : 4};
  if (as_source) {
    o.quadrature = Options::Quadrature::simpson;
    o.differences = Options::Differences::upwind;
  }
  return o;
}

struct Case {
  std::string name;
  Options options;
};

std::vector<Case> cases() {
  using enum Options::Kind;
  return {{"short", compliant(compliant_short, 0.1, 40, false)},
          {"short_as_source", compliant(compliant_short, 1.0, 50, true)},
          {"long", compliant(compliant_long, 0.1, 41, false)},
          {"long_as_source", compliant(compliant_long, 1.0, 50, true)},
          {"finite", compliant(compliant_finite, 0.1, 20, false)},
          {"finite_as_source", compliant(compliant_finite, 1.0, 22, true)}};
}

const Motion kMoving = motion(cylinder(), {0.2, -0.4, 0.0, 0.0}, {0.05, -0.08, 0.0, 0.0}, kSpeed);

Motion still(double x, double y) {
  return motion(cylinder(), {x, y, 0.0, 0.0}, {}, kSpeed);
}

std::vector<double> relaxed(StateModel& film, const Motion& m) {
  std::vector<double> s(film.states());
  film.unloaded(m, s);
  relax(film, m, s);
  return s;
}

Response static_response(const Options& o, const Motion& m) {
  auto film = make_state_model(cylinder(), o, oil());
  const auto s = relaxed(*film, m);
  StateResponse r;
  film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::tangents, r);
  return r.journal;
}

class Compliant : public ::testing::TestWithParam<Case> {};

// A state off equilibrium, smooth and with rates.
struct Point {
  Motion motion;
  std::vector<double> states, rates;
};

Point point(StateModel& film) {
  Point p{kMoving, relaxed(film, still(0.2, -0.4)), {}};
  for (std::size_t k = 0; k < p.states.size(); ++k) {
    const double c = film.state_scale(), angle = 0.3 * static_cast<double>(k);
    p.states[k] += 0.02 * c * std::sin(angle);
    p.rates.push_back(0.1 * c * kSpeed * std::cos(angle));
  }
  return p;
}

// Along random directions in each group of arguments the remainders of residual and force must fall as e^2.
TEST_P(Compliant, TaylorRemainderIsSecondOrder) {
  auto film = make_state_model(cylinder(), GetParam().options, oil());
  const double c = film->state_scale();
  const Point base = point(*film);
  StateResponse at, there;
  film->evaluate(base.motion, base.states, base.rates, Need::tangents, at);
  const std::size_t n = film->states();
  ASSERT_EQ(at.residual.size(), n);
  for (int group = 0; group < 5; ++group) {
    std::array<double, 2> remainder{};
    double size = 0.0;
    for (std::size_t turn = 0; turn < 2; ++turn) {
      const double e = turn == 0 ? 1e-4 : 0.5e-4;
      Point moved = base;
      std::vector<double> g(n, 0.0);
      std::array<double, 2> f{};
      const auto direction = [](std::size_t k) { return std::sin(1.0 + 2.3 * static_cast<double>(k)); };
      for (std::size_t k = 0; k < n; ++k) {
        if (group == 0) moved.states[k] += e * c * direction(k);
        if (group == 1) moved.rates[k] += e * c * kSpeed * direction(k);
      }
      for (const Entry& entry : group == 0 ? at.d_states : group == 1 ? at.d_rates : std::vector<Entry>{})
        g[static_cast<std::size_t>(entry.row)] +=
            entry.value * e * c * (group == 0 ? 1.0 : kSpeed) * direction(static_cast<std::size_t>(entry.column));
      for (std::size_t k = 0; k < n && group == 0; ++k)
        for (std::size_t i = 0; i < 2; ++i) f[i] += at.force_d_states[k][i] * e * c * direction(k);
      for (std::size_t j = 0; j < 2 && (group == 2 || group == 3); ++j) {
        const double step = e * c * direction(j) * (group == 2 ? 1.0 : kSpeed);
        (group == 2 ? moved.motion.position : moved.motion.velocity)[j] += step;
        for (std::size_t k = 0; k < n; ++k) g[k] += (group == 2 ? at.d_position : at.d_velocity)[k][j] * step;
        for (std::size_t i = 0; i < 2; ++i)
          f[i] += (group == 2 ? at.journal.d_position : at.journal.d_velocity)[i][j] * step;
      }
      if (group == 4) {
        moved.motion.speed += e * kSpeed;
        for (std::size_t k = 0; k < n; ++k) g[k] += at.d_speed[k] * e * kSpeed;
        for (std::size_t i = 0; i < 2; ++i) f[i] += at.journal.d_speed[i] * e * kSpeed;
      }
      film->evaluate(moved.motion, moved.states, moved.rates, Need::force, there);
      for (std::size_t k = 0; k < n; ++k) {
        remainder[turn] += std::abs(there.residual[k] - at.residual[k] - g[k]) / (c * kSpeed);
        size += std::abs(g[k]) / (c * kSpeed);
      }
      const double load = std::hypot(at.journal.force[0], at.journal.force[1]);
      for (std::size_t i = 0; i < 2; ++i) {
        remainder[turn] += std::abs(there.journal.force[i] - at.journal.force[i] - f[i]) / load;
        size += std::abs(f[i]) / load;
      }
    }
    if (group != 3) {
      EXPECT_GT(size, 1e-5) << group;
    }
    if (remainder[1] < 1e-10 * (1.0 + size)) continue;  // linear up to rounding
    EXPECT_GE(std::log2(remainder[0] / remainder[1]), 1.9) << GetParam().name << " group " << group;
  }
}

TEST_P(Compliant, PatternForceAndHistory) {
  auto film = make_state_model(cylinder(), GetParam().options, oil());
  auto fresh = make_state_model(cylinder(), GetParam().options, oil());
  const Point p = point(*film);
  StateResponse a, b;
  film->evaluate(p.motion, p.states, p.rates, Need::tangents, a);
  std::vector<double> flat(film->states());
  film->unloaded(still(0.0, 0.0), flat);
  film->evaluate(still(0.0, 0.0), flat, flat, Need::tangents, b);
  ASSERT_EQ(a.d_states.size(), b.d_states.size());
  std::vector<int> per_row(film->states(), 0);
  for (std::size_t k = 0; k < a.d_states.size(); ++k) {
    EXPECT_EQ(a.d_states[k].row, b.d_states[k].row);
    EXPECT_EQ(a.d_states[k].column, b.d_states[k].column);
    ++per_row[static_cast<std::size_t>(a.d_states[k].row)];
  }
  for (const Entry& e : a.d_rates) ++per_row[static_cast<std::size_t>(e.row)];
  EXPECT_LE(*std::max_element(per_row.begin(), per_row.end()), film->row_entries());
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(b.journal.force[i], 0.0, 1e-12 * std::abs(a.journal.force[1]));
  fresh->evaluate(p.motion, p.states, p.rates, Need::force, b);
  EXPECT_EQ(a.journal.force, b.journal.force);
  EXPECT_EQ(a.residual, b.residual);
}

TEST_P(Compliant, ContactIsADomainError) {
  auto film = make_state_model(cylinder(), GetParam().options, oil());
  Point p = point(*film);
  StateResponse r;
  p.states[7] = 0.0;
  EXPECT_THROW(film->evaluate(p.motion, p.states, p.rates, Need::force, r), core::DomainError);
  p.states[7] = std::nan("");
  EXPECT_THROW(film->evaluate(p.motion, p.states, p.rates, Need::force, r), core::DomainError);
}

TEST_P(Compliant, ResamplingKeepsTheFilm) {
  auto film = make_state_model(cylinder(), GetParam().options, oil());
  Options twice = GetParam().options;
  for (int& cells : twice.cells) cells *= 2;
  auto fine = make_state_model(cylinder(), twice, oil());
  const Motion m = still(0.2, -0.4);
  const auto coarse = relaxed(*film, m);
  std::vector<double> between(fine->states()), back(film->states());
  fine->resample(m, *film, coarse, between);
  film->resample(m, *fine, between, back);
  for (std::size_t k = 0; k < back.size(); ++k) EXPECT_NEAR(back[k], coarse[k], 1e-12 * film->state_scale());
}

INSTANTIATE_TEST_SUITE_P(Films, Compliant, ::testing::ValuesIn(cases()),
                         [](const auto& which) { return which.param.name; });

// A stiff liner gives the rigid films; the difference is proportional to B.
TEST(CompliantLimits, StiffLinerIsTheRigidFilm) {
  using enum Options::Kind;
  for (const auto& [soft, hard] : {std::pair{compliant_short, short_bearing}, std::pair{compliant_long, long_inlet}}) {
    Options rigid;
    rigid.kind = hard;
    auto model = make_model(cylinder(), rigid, oil());
    const Motion m = still(0.3, -0.3);
    const Response exact = evaluate(*model, m);
    std::array<double, 2> error{};
    for (std::size_t k = 0; k < 2; ++k) {
      const Response r = static_response(compliant(soft, k == 0 ? 2e-3 : 1e-3, 800, false), m);
      error[k] = std::hypot(r.force[0] - exact.force[0], r.force[1] - exact.force[1]) /
                 std::hypot(exact.force[0], exact.force[1]);
    }
    EXPECT_LT(error[1], 2e-3);
    EXPECT_NEAR(error[0] / error[1], 2.0, 0.1) << "B to " << error[1];
  }
}

// Stiffness and damping with a stiff liner are the rigid tangents; the static stiffness is the slope of static forces.
TEST(CompliantLimits, CoefficientsOfAStiffLinerAndSlopeOfStaticForces) {
  using enum Options::Kind;
  Options rigid;
  rigid.kind = short_bearing;
  auto model = make_model(cylinder(), rigid, oil());
  const Motion m = still(0.3, -0.3);
  const Response exact = evaluate(*model, m);
  auto film = make_state_model(cylinder(), compliant(compliant_short, 1e-4, 800, false), oil());
  const Coefficients c = coefficients(*film, m, relaxed(*film, m), kSpeed);
  double size = 0.0;
  for (const auto& row : exact.d_position) size = std::max({size, std::abs(row[0]), std::abs(row[1])});
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_NEAR(c.stiffness[2 * i + j], -exact.d_position[i][j], 5e-3 * size);
      EXPECT_NEAR(c.damping[2 * i + j] * kSpeed, -exact.d_velocity[i][j] * kSpeed, 5e-3 * size);
    }
  for (const auto kind : {compliant_short, compliant_long}) {
    const Options soft = compliant(kind, 0.5, 60, false);
    auto other = make_state_model(cylinder(), soft, oil());
    const Coefficients slow = coefficients(*other, m, relaxed(*other, m), 1e-3);
    const double step = 1e-5;
    for (std::size_t j = 0; j < 2; ++j) {
      const Response plus = static_response(soft, still(0.3 + (j == 0 ? step : 0.0), -0.3 + (j == 1 ? step : 0.0)));
      const Response minus = static_response(soft, still(0.3 - (j == 0 ? step : 0.0), -0.3 - (j == 1 ? step : 0.0)));
      for (std::size_t i = 0; i < 2; ++i) {
        const double slope = (plus.force[i] - minus.force[i]) / (2.0 * step * cylinder().clearance);
        EXPECT_NEAR(slow.stiffness[2 * i + j], -slope, 1e-5 * size);
      }
    }
  }
}

TEST(CompliantLimits, StaticForceIsOfSecondOrder) {
  using enum Options::Kind;
  for (const auto kind : {compliant_short, compliant_long, compliant_finite}) {
    std::array<std::array<double, 4>, 4> f{};
    for (std::size_t k = 0; k < 4; ++k) {
      Options o = compliant(kind, 0.1, (kind == compliant_finite ? 15 : 60) << k, false);
      o.cells[1] = 4 << k;
      f[k] = static_response(o, still(0.3, -0.3)).force;
    }
    const auto change = [&](std::size_t k) { return std::hypot(f[k + 1][0] - f[k][0], f[k + 1][1] - f[k][1]); };
    EXPECT_NEAR(std::log2(change(1) / change(2)), 2.0, 0.3);
  }
}

// P = Q (cos(theta - a) + 0.3) cos(pi z/L) on prescribed thickness and rates: residual and force of second order, on
// meshes that are not square.
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
  for (const bool as_source : {false, true}) {
    std::array<double, 3> residual{}, force{};
    for (std::size_t level = 0; level < 3; ++level) {
      Options o = compliant(Options::Kind::compliant_finite, 0.4, 40 << level, as_source);
      o.cells[1] = 14 << level;
      auto film = make_state_model(g, o, oil());
      std::vector<double> states, rates;
      for (int i = 0; i < o.cells[0]; ++i)
        for (int j = 1; j < o.cells[1]; ++j) {
          const double theta = 0.5 * pi + 2.0 * pi * i / o.cells[0],
                       z = pi * (static_cast<double>(j) / o.cells[1] - 0.5);
          const double f = std::cos(theta - a) + tilt, ft = -std::sin(theta - a);
          const double p = Q * f * std::cos(z), pt = Q * ft * std::cos(z), ptt = Q * (tilt - f) * std::cos(z);
          const double pz = -pi * Q * f * std::sin(z), pzz = -pi * pi * p;
          const double h = 1.0 - ex * std::cos(theta) - ey * std::sin(theta) + b * p;
          const double ht = ex * std::sin(theta) - ey * std::cos(theta) + b * pt, hz = b * pz;
          states.push_back(c * h);
          rates.push_back(
              0.5 * c *
              (3.0 * h * h * ht * pt + h * h * h * ptt + k * (3.0 * h * h * hz * pz + h * h * h * pzz) - kSpeed * ht));
        }
      StateResponse r;
      film->evaluate(motion(g, {ex, ey, 0.0, 0.0}, {}, kSpeed), states, rates, Need::force, r);
      for (const double value : r.residual) residual[level] += std::pow(value / c, 2);
      residual[level] = std::sqrt(residual[level] / static_cast<double>(r.residual.size()));
      force[level] = std::hypot(r.journal.force[0] - exact[0], r.journal.force[1] - exact[1]);
    }
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
  using enum Options::Kind;
  const auto away = [](double length_to_diameter, const Options& rigid, std::array<int, 2> cells, double compliance) {
    Geometry g = cylinder();
    g.length = 2.0 * g.radius * length_to_diameter;
    Options o = compliant(compliant_finite, compliance, cells[0], false);
    o.cells = cells;
    auto film = make_state_model(g, o, oil());
    const Motion m = motion(g, {0.3, -0.3, 0.0, 0.0}, {}, kSpeed);
    StateResponse r;
    const auto s = relaxed(*film, m);
    film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::force, r);
    const Response exact = evaluate(*make_model(g, rigid, oil()), m);
    return std::hypot(r.journal.force[0] - exact.force[0], r.journal.force[1] - exact.force[1]) /
           std::hypot(exact.force[0], exact.force[1]);
  };
  Options thin, wide;
  thin.kind = short_bearing;
  wide.kind = long_bearing;
  const double a = away(0.3, thin, {120, 24}, 0.1), b = away(0.15, thin, {120, 24}, 0.1);
  EXPECT_LT(b, 0.03);
  EXPECT_NEAR(std::log2(a / b), 2.0, 0.4);
  const double c = away(8.0, wide, {48, 60}, 1e-3), d = away(16.0, wide, {48, 120}, 1e-3);
  EXPECT_LT(d, 0.06);
  EXPECT_NEAR(std::log2(c / d), 1.0, 0.2);
}

TEST(CompliantLimits, ALinerIsItsCompliance) {
  Options by_b = compliant(Options::Kind::compliant_short, 0.1, 40, false), by_liner = by_b;
  const Geometry g = cylinder();
  // B = 6 mu Omega_0 d (1 + nu)(1 - 2 nu)/((c/R)^2 c E (1 - nu))
  const double d = 2e-3, nu = 0.3, ratio = g.clearance / g.radius;
  const double modulus = 6.0 * oil().viscosity * by_b.reference_speed * d * (1.0 + nu) * (1.0 - 2.0 * nu) /
                         (ratio * ratio * g.clearance * 0.1 * (1.0 - nu));
  by_liner.compliance.reset();
  by_liner.liner = Liner{d, modulus, nu};
  const Response a = static_response(by_b, still(0.2, -0.4)), b = static_response(by_liner, still(0.2, -0.4));
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(a.force[i], b.force[i], 1e-10 * std::abs(a.force[1]));
  by_liner.compliance = 0.1;
  EXPECT_THROW(make_state_model(g, by_liner, oil()), core::InputError);
  by_b.cells[0] = 3;
  EXPECT_THROW(make_state_model(g, by_b, oil()), core::InputError);
}

TEST(CompliantLimits, ReportsAgreeWithTheRigidFilm) {
  using enum Options::Kind;
  Options rigid;
  rigid.kind = short_bearing;
  const Motion m = still(0.3, -0.3);
  const Summary exact = make_model(cylinder(), rigid, oil())->summary(m);
  auto film = make_state_model(cylinder(), compliant(compliant_short, 1e-4, 800, false), oil());
  const auto s = relaxed(*film, m);
  const Summary r = film->summary(m, s);
  EXPECT_NEAR(r.power_loss, exact.power_loss, 2e-3 * exact.power_loss);
  EXPECT_NEAR(r.side_flow, exact.side_flow, 2e-3 * exact.side_flow);
  EXPECT_NEAR(r.max_pressure, exact.max_pressure, 2e-3 * exact.max_pressure);
  EXPECT_NEAR(r.min_thickness, exact.min_thickness, 2e-3 * exact.min_thickness);
  const auto fields = film->fields(m, s);
  ASSERT_EQ(fields.size(), 4u);
  EXPECT_EQ(fields[2].values.size(), fields[0].values.size() * fields[1].values.size());
}

}  // namespace
}  // namespace whirl::film::testing
