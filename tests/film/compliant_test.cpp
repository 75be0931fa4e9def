// Films with elastic liners: limits, orders of accuracy, coefficients.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "film/compliant_cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

class CompliantFilms : public ::testing::TestWithParam<CompliantCase> {};

// Asperities take part where they are asked for. They do not show in the force as long as the film stays positive
// beneath them: both together carry what the liner does.
TEST_P(CompliantFilms, ContactCarries) {
  Elastic o = GetParam().options;
  if (!o.contact) GTEST_SKIP() << "without contact";
  auto with = make_film(cylinder(), o, oil());
  o.contact.reset();
  auto without = make_film(cylinder(), o, oil());
  const CompliantPoint base = point(o);
  StateResponse a, b;
  with->evaluate(base.motion, base.states, base.rates, Need::tangents, a);
  without->evaluate(base.motion, base.states, base.rates, Need::tangents, b);
  double apart = 0.0, size = 0.0;
  for (std::size_t k = 0; k < a.residual.size(); ++k) {
    apart += std::abs(a.residual[k] - b.residual[k]);
    size += std::abs(b.residual[k]);
  }
  EXPECT_GT(apart, 0.05 * size);
}

TEST_P(CompliantFilms, ContactIsADomainError) {
  auto film = make_film(cylinder(), GetParam().options, oil());
  CompliantPoint p = point(GetParam().options);
  StateResponse r;
  p.states[7] = 0.0;
  EXPECT_THROW(film->evaluate(p.motion, p.states, p.rates, Need::force, r), core::DomainError);
  p.states[7] = std::nan("");
  EXPECT_THROW(film->evaluate(p.motion, p.states, p.rates, Need::force, r), core::DomainError);
}

TEST_P(CompliantFilms, ResamplingKeepsTheFilm) {
  auto film = make_film(cylinder(), GetParam().options, oil());
  Elastic twice = GetParam().options;
  for (int& cells : twice.cells) cells *= 2;
  auto fine = make_film(cylinder(), twice, oil());
  const JournalMotion m = still(0.2, -0.4);
  const auto coarse = relaxed(*film, m);
  std::vector<double> between(fine->states()), back(film->states());
  fine->resample(m, *film, coarse, between);
  film->resample(m, *fine, between, back);
  for (std::size_t k = 0; k < back.size(); ++k) EXPECT_NEAR(back[k], coarse[k], 1e-12 * scale_of(*film));
}

INSTANTIATE_TEST_SUITE_P(Films, CompliantFilms, ::testing::ValuesIn(compliant_films()),
                         [](const auto& which) { return which.param.name; });

// A stiff liner gives the rigid films; the difference is proportional to B.
TEST(CompliantLimits, StiffLinerIsTheRigidFilm) {
  using enum Kind;
  for (const auto& [soft, hard] : {std::pair{compliant_short, short_bearing}, std::pair{compliant_long, long_inlet}}) {
    const Options rigid = film_of(hard);
    auto model = make_film(cylinder(), rigid, oil());
    const JournalMotion m = still(0.3, -0.3);
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
  using enum Kind;
  const Short rigid;
  auto model = make_film(cylinder(), rigid, oil());
  const JournalMotion m = still(0.3, -0.3);
  const Response exact = evaluate(*model, m);
  auto film = make_film(cylinder(), compliant(compliant_short, 1e-4, 800, false), oil());
  const Coefficients c = coefficients(*film, m, relaxed(*film, m), kSpeed);
  double size = 0.0;
  for (const auto& row : exact.d_position) size = std::max({size, std::abs(row[0]), std::abs(row[1])});
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_NEAR(c.stiffness[2 * i + j], -exact.d_position[i][j], 5e-3 * size);
      EXPECT_NEAR(c.damping[2 * i + j] * kSpeed, -exact.d_velocity[i][j] * kSpeed, 5e-3 * size);
    }
  for (const auto kind : {compliant_short, compliant_long}) {
    const Elastic soft = compliant(kind, 0.5, 60, false);
    auto other = make_film(cylinder(), soft, oil());
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

// A film that carries nothing has the residual Omega/2 dh/dtheta alone.
TEST(CompliantLimits, OrdersOfTheDifferences) {
  using enum Compliant::Differences;
  for (const auto kind : {Kind::compliant_short, Kind::compliant_finite})
    for (const auto& [differences, order] : {std::pair{central, 2.0}, {upwind, 2.0}, {third_order, 3.0}}) {
      std::array<double, 2> error{};
      for (std::size_t k = 0; k < 2; ++k) {
        Elastic o = compliant(kind, 0.1, 40 << k, false);
        o.differences = differences;
        auto film = make_film(cylinder(), o, oil());
        std::vector<double> s(film->states());
        film->unloaded(still(0.3, -0.4), s);
        StateResponse r;
        film->evaluate(still(0.3, -0.4), s, std::vector<double>(s.size(), 0.0), Need::force, r);
        const double theta = 90.0 * kDegree + 7 * 9.0 * kDegree;  // node 7 of 40
        const double exact = 0.5 * kSpeed * cylinder().clearance * (0.3 * std::sin(theta) + 0.4 * std::cos(theta));
        const std::size_t line = kind == Kind::compliant_finite ? static_cast<std::size_t>(o.cells[1] - 1) : 1;
        error[k] = std::abs(r.residual[(7 << k) * line] - exact);
      }
      EXPECT_NEAR(std::log2(error[0] / error[1]), order, 0.3);
    }
}

TEST(CompliantLimits, StaticForceIsOfSecondOrder) {
  using enum Kind;
  for (const auto kind : {compliant_short, compliant_long, compliant_finite}) {
    std::array<std::array<double, 4>, 4> f{};
    for (std::size_t k = 0; k < 4; ++k) {
      Elastic o = compliant(kind, 0.1, (kind == compliant_finite ? 15 : 60) << k, false);
      o.cells[1] = 4 << k;
      f[k] = static_response(o, still(0.3, -0.3)).force;
    }
    const auto change = [&](std::size_t k) { return std::hypot(f[k + 1][0] - f[k][0], f[k + 1][1] - f[k][1]); };
    EXPECT_NEAR(std::log2(change(1) / change(2)), 2.0, 0.3);
  }
}

TEST(CompliantLimits, ALinerIsItsCompliance) {
  Elastic by_b = compliant(Kind::compliant_short, 0.1, 40, false), by_liner = by_b;
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
  EXPECT_THROW(make_film(g, by_liner, oil()), core::InputError);
  by_b.cells[0] = 3;
  EXPECT_THROW(make_film(g, by_b, oil()), core::InputError);
}

TEST(CompliantLimits, ReportsAgreeWithTheRigidFilm) {
  using enum Kind;
  const Short rigid;
  const JournalMotion m = still(0.3, -0.3);
  const FilmReport exact = make_film(cylinder(), rigid, oil())->summary(m, {});
  auto film = make_film(cylinder(), compliant(compliant_short, 1e-4, 800, false), oil());
  const auto s = relaxed(*film, m);
  const FilmReport r = film->summary(m, s);
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
