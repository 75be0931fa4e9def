// Films whose content is their state: the same equations as without states, balances, limits.
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

class Content : public ::testing::TestWithParam<ContentCase> {};

// With contents that do not change, the film is the one without states: in any motion, to rounding.
TEST_P(Content, IsTheCondensedFilmWhereItsContentStays) {
  const ContentCase& c = GetParam();
  auto film = make_film(c.geometry, c.options, oil());
  auto condensed = make_film(c.geometry, without_states(c.options), oil());
  for (const double speed : {377.0, -250.0}) {
    const JournalMotion m = motion(c.geometry, c.position, c.velocity, speed);
    std::vector<double> q = settled(*film, m);
    StateResponse r;
    film->evaluate(m, q, std::vector<double>(q.size(), 0.0), Need::tangents, r);
    const Response other = evaluate(*condensed, m);
    EXPECT_TRUE(std::any_of(q.begin(), q.end(), [](double x) { return x < 0.0; }));
    const double load = std::hypot(other.force[0], other.force[1]);
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_NEAR(r.journal.force[i], other.force[i], 1e-9 * load * (i < 2 ? 1.0 : c.geometry.length)) << c.name << i;
    EXPECT_EQ(r.journal.min_thickness, other.min_thickness);
    const auto own = film->fields(m, q), theirs = condensed->fields(m, {});
    ASSERT_EQ(own.size(), theirs.size());
    for (std::size_t f = 0; f < own.size(); ++f) {
      ASSERT_EQ(own[f].name, theirs[f].name);
      double scale = 1e-9;
      for (const double x : theirs[f].values) scale = std::max(scale, 1e-9 * std::abs(x));
      for (std::size_t k = 0; k < own[f].values.size(); ++k)
        ASSERT_NEAR(own[f].values[k], theirs[f].values[k], scale) << own[f].name << " " << k;
    }
    // Eliminated, its tangents are those of the other one.
    const Eliminated tangents = eliminate(*film, r);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_NEAR(tangents.d_position[i][j], other.d_position[i][j], 1e-7 * std::abs(other.d_position[1][1]));
        EXPECT_NEAR(tangents.d_velocity[i][j], other.d_velocity[i][j], 1e-7 * std::abs(other.d_velocity[1][1]));
      }
    EXPECT_NEAR(tangents.d_speed[1], other.d_speed[1], 1e-7 * std::abs(other.d_speed[1]));
  }
}

// What enters, leaves and is pressed out is what the content gains: with any content, to rounding.
TEST_P(Content, WhatEntersIsStored) {
  const ContentCase& c = GetParam();
  auto film = make_film(c.geometry, c.options, oil());
  const JournalMotion m = motion(c.geometry, c.position, c.velocity, 377.0);
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<double> q(film->states());
  for (double& x : q) x = scale_of(*film) * std::min(0.8 * uniform(engine), 1e-4);
  StateResponse r;
  film->evaluate(m, q, std::vector<double>(q.size(), 0.0), Need::force, r);
  double stored = 0.0;
  const std::vector<double> cells = cell_areas(c.geometry, c.options);
  ASSERT_EQ(cells.size(), q.size());
  for (std::size_t k = 0; k < q.size(); ++k) stored -= cells[k] * r.residual[k];  // q' where g = 0
  const FilmReport s = film->summary(m, q);
  EXPECT_NEAR(s.imbalance, stored, 1e-12 * (std::abs(s.inlet_flow) + std::abs(s.side_flow)));
  EXPECT_GT(std::abs(s.imbalance), 1e-3 * std::abs(s.inlet_flow));
  // Nothing is stored in equilibrium.
  const JournalMotion still = motion(c.geometry, c.position, {}, 377.0);
  q = settled(*film, still);
  const FilmReport at_rest = film->summary(still, q);
  EXPECT_LT(std::abs(at_rest.imbalance), 1e-10 * at_rest.inlet_flow);
}

TEST_P(Content, ThicknessMustBePositive) {
  const ContentCase& c = GetParam();
  auto film = make_film(c.geometry, c.options, oil());
  const std::vector<double> q(film->states(), 0.0);
  StateResponse r;
  EXPECT_THROW(film->evaluate(motion(c.geometry, {0.0, -1.01, 0.0, 0.0}, {}, 377.0), q, q, Need::force, r),
               core::DomainError);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(film->evaluate(motion(c.geometry, {nan, 0.0, 0.0, 0.0}, {}, 377.0), q, q, Need::force, r),
               core::DomainError);
  const JournalMotion m = motion(c.geometry, c.position, {}, 377.0);
  EXPECT_EQ(film->least_thickness(m, q),
            evaluate(*make_film(c.geometry, without_states(c.options), oil()), m).min_thickness);
}

// At rest a film that starts full stays full, and its equations are regular: nothing drives it but what grooves press
// in.
TEST_P(Content, RestIsRegular) {
  const ContentCase& c = GetParam();
  auto film = make_film(c.geometry, c.options, oil());
  const JournalMotion rest = motion(c.geometry, c.position, {}, 0.0);
  const std::vector<double> q = settled(*film, rest);
  double feed = 0.0;
  for (const Groove& g : c.options.grooves) feed = std::max(feed, g.pressure);
  for (const Hole& h : c.options.holes) feed = std::max(feed, h.pressure);
  for (const double x : q) EXPECT_TRUE(x >= 0.0 && x <= 2.0 * c.geometry.clearance * feed / c.options.bulk_modulus);
  // A cavity that is left at rest keeps what it holds.
  std::vector<double> hollow(q.size(), -0.2 * c.geometry.clearance);
  StateResponse r;
  film->evaluate(rest, hollow, std::vector<double>(q.size(), 0.0), Need::tangents, r);
  for (const double g : r.residual) EXPECT_TRUE(feed > 0.0 || g == 0.0);
  const Share& all = film->whole();
  EXPECT_EQ(r.d_rates.size(), q.size());
  for_entries(all, all.d_rates, r.d_rates, [](int i, int j, double v) { EXPECT_EQ(v, i == j ? 1.0 : 0.0); });
}

// On its own mesh nothing is lost, on another one the pressure is about the same.
TEST_P(Content, ResamplesToOtherMeshes) {
  const ContentCase& c = GetParam();
  Reynolds finer = c.options;
  finer.cells = {2 * c.options.cells[0], 2 * c.options.cells[1]};
  auto film = make_film(c.geometry, c.options, oil()), fine = make_film(c.geometry, finer, oil());
  const JournalMotion m = motion(c.geometry, c.position, {}, 377.0);
  const std::vector<double> q = settled(*film, m), exact = settled(*fine, m);
  std::vector<double> same(q.size()), to(fine->states());
  film->resample(m, *film, q, same);
  for (std::size_t k = 0; k < q.size(); ++k) EXPECT_NEAR(same[k], q[k], 1e-12 * scale_of(*film));
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

INSTANTIATE_TEST_SUITE_P(Films, Content, ::testing::ValuesIn(content_films()),
                         [](const auto& which) { return which.param.name; });

// Equilibria do not feel the compressibility; the number of states is near what is said beforehand.
TEST(ContentFilm, CompressibilityIsOfTheMotionOnly) {
  Reynolds stiff = dynamic({40, 10}), soft = stiff;
  soft.bulk_modulus = 1e7;
  const JournalMotion m = motion(lemon(), {0.3, -0.5, 0.0, 0.0}, {}, 377.0);
  auto a = make_film(lemon(), stiff, oil()), b = make_film(lemon(), soft, oil());
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
  EXPECT_THROW((void)make_film(cylinder(), turning, oil()), core::InputError);
  EXPECT_THROW((void)make_film(cylinder(), dynamic({40, 10}), oil()), core::InputError);
  Reynolds soft = dynamic({40, 10});
  soft.bulk_modulus = 0.0;
  EXPECT_THROW((void)make_film(lemon(), soft, oil()), core::InputError);
}

}  // namespace
}  // namespace whirl::film::testing
