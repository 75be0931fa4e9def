// Films whose content is their state: the same equations as without states, exact derivatives, balances, limits.
#include <gtest/gtest.h>

#include <Eigen/SparseLU>
#include <algorithm>
#include <limits>
#include <random>
#include <string>

#include "film/cases.hpp"
#include "film/content_cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

struct Case {
  std::string name;
  Geometry geometry;
  Reynolds options;
  std::array<double, 4> position, velocity;
};

std::vector<Case> cases() {
  const std::array<double, 4> loaded = {0.5, -0.4, 0.2, -0.15}, moving = {0.05, -0.08, 0.03, 0.02};
  const std::array<double, 4> shallow = {0.2, -0.6, 0.1, 0.1};
  Reynolds turbulent = dynamic({40, 12});
  turbulent.turbulence = Turbulence::constantinescu;
  Reynolds starved = dynamic({37, 11});
  starved.edge_fill = 0.7;
  Reynolds tilted = dynamic({23, 9});
  tilted.tilt = true;
  tilted.edge_fill = 0.9;
  Reynolds fed = dynamic({48, 12});
  fed.grooves = {{90.0 * kDegree, 20.0 * kDegree, 2e5}, {-30.0 * kDegree, 0.0, 0.0}};
  Reynolds line = dynamic({40, 10});
  line.inlet = {Inlet::Type::line, 100.0 * kDegree};
  Geometry offset = lemon();
  offset.offset = 0.4 * offset.clearance;
  return {{"lemon", lemon(), turbulent, loaded, moving},
          {"lemon_tilted", offset, tilted, loaded, moving},
          {"arc_starved", arc(), starved, shallow, moving},
          {"grooved", cylinder(), fed, shallow, moving},
          {"inlet_line", cylinder(), line, {0.3, -0.5}, moving}};
}

class Content : public ::testing::TestWithParam<Case> {};

// With contents that do not change, the film is the one without states: in any motion, to rounding.
TEST_P(Content, IsTheCondensedFilmWhereItsContentStays) {
  const Case& c = GetParam();
  auto film = make_state_model(c.geometry, c.options, oil());
  auto condensed = make_model(c.geometry, without_states(c.options), oil());
  for (const double speed : {377.0, -250.0}) {
    const Motion m = motion(c.geometry, c.position, c.velocity, speed);
    std::vector<double> q = settled(*film, m);
    StateResponse r;
    film->evaluate(m, q, std::vector<double>(q.size(), 0.0), Need::tangents, r);
    const Response other = evaluate(*condensed, m);
    EXPECT_TRUE(std::any_of(q.begin(), q.end(), [](double x) { return x < 0.0; }));
    const double load = std::hypot(other.force[0], other.force[1]);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(r.journal.force[i], other.force[i], 1e-9 * load * (i < 2 ? 1.0 : c.geometry.length)) << c.name << i;
    EXPECT_EQ(r.journal.min_thickness, other.min_thickness);
    const auto own = film->fields(m, q), theirs = condensed->fields(m);
    ASSERT_EQ(own.size(), theirs.size());
    for (std::size_t f = 0; f < own.size(); ++f) {
      ASSERT_EQ(own[f].name, theirs[f].name);
      double scale = 1e-9;
      for (const double x : theirs[f].values) scale = std::max(scale, 1e-9 * std::abs(x));
      for (std::size_t k = 0; k < own[f].values.size(); ++k)
        ASSERT_NEAR(own[f].values[k], theirs[f].values[k], scale) << own[f].name << " " << k;
    }
    // Eliminated, its tangents are those of the other one.
    const Eliminated tangents = eliminate(r);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_NEAR(tangents.d_position[i][j], other.d_position[i][j], 1e-7 * std::abs(other.d_position[1][1]));
        EXPECT_NEAR(tangents.d_velocity[i][j], other.d_velocity[i][j], 1e-7 * std::abs(other.d_velocity[1][1]));
      }
    EXPECT_NEAR(tangents.d_speed[1], other.d_speed[1], 1e-7 * std::abs(other.d_speed[1]));
  }
}

// |g(s + e d) - g(s) - e dg d| must fall as e^2 in every direction, and that of the force alike. States stay away from
// the kinks at q = 0, where a node becomes full.
TEST_P(Content, TaylorRemainderIsSecondOrder) {
  const Case& c = GetParam();
  auto film = make_state_model(c.geometry, c.options, oil());
  const Motion base = motion(c.geometry, c.position, c.velocity, 377.0);
  const std::size_t n = film->states();
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(0.2, 1.0);
  const double scale = film->state_scale();
  std::vector<double> q(n), rates(n), along(n), along_rates(n);
  for (std::size_t k = 0; k < n; ++k) {
    q[k] = uniform(engine) * (engine() % 2 ? 1e-3 : -0.5) * scale;
    rates[k] = uniform(engine) * scale * 100.0;
    along[k] = (uniform(engine) - 0.6) * q[k];
    along_rates[k] = uniform(engine) * scale * 100.0;
  }
  StateResponse at, there;
  film->evaluate(base, q, rates, Need::tangents, at);
  EXPECT_TRUE(film->constant_rates() && at.force_d_rates.empty());
  for (int direction = 0; direction < 11; ++direction) {
    if (direction % 4 > 1 && direction < 8 && !c.options.tilt) continue;
    std::array<double, 2> by_force{}, by_rows{};
    double slope_of_force = 0.0, slope_of_rows = 0.0;
    for (std::size_t half = 0; half < 2; ++half) {
      const double e = half == 0 ? 2e-3 : 1e-3, step = step_of(c.geometry, direction, e);
      Motion m = base;
      std::vector<double> s = q, ds = rates;
      Response expected = at.journal;
      std::vector<double> g = at.residual;
      const auto j = static_cast<std::size_t>(direction % 4);
      if (direction < 4) m.position[j] += step;
      if (direction >= 4 && direction < 8) m.velocity[j] += step;
      if (direction == 8) m.speed += step;
      for (std::size_t k = 0; k < n; ++k) {
        if (direction == 9) s[k] += e * along[k];
        if (direction == 10) ds[k] += e * along_rates[k];
        if (direction < 4) g[k] += step * at.d_position[k][j];
        if (direction >= 4 && direction < 8) g[k] += step * at.d_velocity[k][j];
        if (direction == 8) g[k] += step * at.d_speed[k];
      }
      for (std::size_t i = 0; i < 4; ++i) {
        if (direction < 4) expected.force[i] += step * at.journal.d_position[i][j];
        for (std::size_t k = 0; k < n && direction == 9; ++k)
          expected.force[i] += e * along[k] * at.force_d_states[k][i];
      }
      const auto add = [&](const std::vector<Entry>& entries, const std::vector<double>& v) {
        for (const Entry& x : entries)
          g[static_cast<std::size_t>(x.row)] += e * x.value * v[static_cast<std::size_t>(x.column)];
      };
      if (direction == 9) add(at.d_states, along);
      if (direction == 10) add(at.d_rates, along_rates);
      film->evaluate(m, s, ds, Need::force, there);
      EXPECT_TRUE(there.d_states.empty() && there.d_position.empty());
      slope_of_force = slope_of_rows = 0.0;
      for (std::size_t i = 0; i < 4; ++i) {
        by_force[half] += std::abs(there.journal.force[i] - expected.force[i]);
        slope_of_force += std::abs(expected.force[i] - at.journal.force[i]);
      }
      for (std::size_t k = 0; k < n; ++k) {
        by_rows[half] += std::abs(there.residual[k] - g[k]);
        slope_of_rows += std::abs(g[k] - at.residual[k]);
      }
    }
    const double load = std::abs(at.journal.force[0]) + std::abs(at.journal.force[1]);
    double size = 0.0;
    for (const double g : at.residual) size += std::abs(g);
    EXPECT_GT(slope_of_rows, 0.0) << direction;
    for (const auto& [r, slope, rounding] :
         {std::tuple(by_force, slope_of_force, 1e-11 * load), std::tuple(by_rows, slope_of_rows, 1e-11 * size)}) {
      if (r[1] < rounding) continue;
      EXPECT_GE(std::log2(r[0] / r[1]), 1.9) << c.name << " direction " << direction;
      EXPECT_LT(r[1], 0.1 * slope) << c.name << " direction " << direction;
    }
  }
}

// What enters, leaves and is pressed out is what the content gains: with any content, to rounding.
TEST_P(Content, WhatEntersIsStored) {
  const Case& c = GetParam();
  auto film = make_state_model(c.geometry, c.options, oil());
  const Motion m = motion(c.geometry, c.position, c.velocity, 377.0);
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> q(film->states());
  for (double& x : q) x = film->state_scale() * std::min(0.8 * uniform(engine), 1e-4);
  StateResponse r;
  film->evaluate(m, q, std::vector<double>(q.size(), 0.0), Need::force, r);
  double stored = 0.0;
  const std::vector<double> cells = cell_areas(c.geometry, c.options);
  ASSERT_EQ(cells.size(), q.size());
  for (std::size_t k = 0; k < q.size(); ++k) stored -= cells[k] * r.residual[k];  // q' where g = 0
  const Summary s = film->summary(m, q);
  EXPECT_NEAR(s.imbalance, stored, 1e-12 * (std::abs(s.inlet_flow) + std::abs(s.side_flow)));
  EXPECT_GT(std::abs(s.imbalance), 1e-3 * std::abs(s.inlet_flow));
  // Nothing is stored in equilibrium.
  const Motion still = motion(c.geometry, c.position, {}, 377.0);
  q = settled(*film, still);
  const Summary at_rest = film->summary(still, q);
  EXPECT_LT(std::abs(at_rest.imbalance), 1e-10 * at_rest.inlet_flow);
}

TEST_P(Content, ThicknessMustBePositive) {
  const Case& c = GetParam();
  auto film = make_state_model(c.geometry, c.options, oil());
  const std::vector<double> q(film->states(), 0.0);
  StateResponse r;
  EXPECT_THROW(film->evaluate(motion(c.geometry, {0.0, -1.01, 0.0, 0.0}, {}, 377.0), q, q, Need::force, r),
               core::DomainError);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(film->evaluate(motion(c.geometry, {nan, 0.0, 0.0, 0.0}, {}, 377.0), q, q, Need::force, r),
               core::DomainError);
  const Motion m = motion(c.geometry, c.position, {}, 377.0);
  EXPECT_EQ(film->least_thickness(m, q),
            evaluate(*make_model(c.geometry, without_states(c.options), oil()), m).min_thickness);
}

// At rest a film that starts full stays full, and its equations are regular: nothing drives it but what grooves press
// in.
TEST_P(Content, RestIsRegular) {
  const Case& c = GetParam();
  auto film = make_state_model(c.geometry, c.options, oil());
  const Motion rest = motion(c.geometry, c.position, {}, 0.0);
  const std::vector<double> q = settled(*film, rest);
  double feed = 0.0;
  for (const Groove& g : c.options.grooves) feed = std::max(feed, g.pressure);
  for (const double x : q) EXPECT_TRUE(x >= 0.0 && x <= 2.0 * c.geometry.clearance * feed / c.options.bulk_modulus);
  // A cavity that is left at rest keeps what it holds.
  std::vector<double> hollow(q.size(), -0.2 * c.geometry.clearance);
  StateResponse r;
  film->evaluate(rest, hollow, std::vector<double>(q.size(), 0.0), Need::tangents, r);
  for (const double g : r.residual) EXPECT_TRUE(feed > 0.0 || g == 0.0);
  for (const Entry& e : r.d_rates) EXPECT_EQ(e.value, e.row == e.column ? 1.0 : 0.0);
}

// On its own mesh nothing is lost, on another one the pressure is about the same.
TEST_P(Content, ResamplesToOtherMeshes) {
  const Case& c = GetParam();
  Reynolds finer = c.options;
  finer.cells = {2 * c.options.cells[0], 2 * c.options.cells[1]};
  auto film = make_state_model(c.geometry, c.options, oil()), fine = make_state_model(c.geometry, finer, oil());
  const Motion m = motion(c.geometry, c.position, {}, 377.0);
  const std::vector<double> q = settled(*film, m), exact = settled(*fine, m);
  std::vector<double> same(q.size()), to(fine->states());
  film->resample(m, *film, q, same);
  for (std::size_t k = 0; k < q.size(); ++k) EXPECT_NEAR(same[k], q[k], 1e-12 * film->state_scale());
  fine->resample(m, *film, q, to);
  StateResponse a, b;
  const std::vector<double> still(to.size(), 0.0);
  fine->evaluate(m, to, still, Need::force, a);
  fine->evaluate(m, exact, still, Need::force, b);
  const double load = std::hypot(b.journal.force[0], b.journal.force[1]);
  EXPECT_NEAR(a.journal.force[0], b.journal.force[0], 0.15 * load);
  EXPECT_NEAR(a.journal.force[1], b.journal.force[1], 0.15 * load);
  EXPECT_GT(load, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Films, Content, ::testing::ValuesIn(cases()),
                         [](const auto& which) { return which.param.name; });

// Equilibria do not feel the compressibility; the number of states is near what is said beforehand.
TEST(ContentFilm, CompressibilityIsOfTheMotionOnly) {
  Reynolds stiff = dynamic({40, 10}), soft = stiff;
  soft.bulk_modulus = 1e7;
  const Motion m = motion(lemon(), {0.3, -0.5, 0.0, 0.0}, {}, 377.0);
  auto a = make_state_model(lemon(), stiff, oil()), b = make_state_model(lemon(), soft, oil());
  StateResponse ra, rb;
  const auto qa = settled(*a, m), qb = settled(*b, m);
  const std::vector<double> still(qa.size(), 0.0);
  a->evaluate(m, qa, still, Need::force, ra);
  b->evaluate(m, qb, still, Need::force, rb);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_NEAR(ra.journal.force[i], rb.journal.force[i], 1e-9 * std::abs(rb.journal.force[1]));
  EXPECT_NEAR(static_cast<double>(a->states()), facts(stiff, lemon()).states, 0.2 * facts(stiff, lemon()).states);
  EXPECT_EQ(facts(without_states(stiff), lemon()).states, 0);
}

TEST(ContentFilm, ImpossibleOptionsAreInputErrors) {
  Reynolds turning = dynamic({40, 10});
  turning.inlet = {Inlet::Type::maximum_gap, 0.0};
  EXPECT_THROW((void)make_state_model(cylinder(), turning, oil()), core::InputError);
  EXPECT_THROW((void)make_state_model(cylinder(), dynamic({40, 10}), oil()), core::InputError);
  Reynolds soft = dynamic({40, 10});
  soft.bulk_modulus = 0.0;
  EXPECT_THROW((void)make_state_model(lemon(), soft, oil()), core::InputError);
}

}  // namespace
}  // namespace whirl::film::testing
