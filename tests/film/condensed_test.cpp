// Films with states whose steady equations are solved inside: exact tangents, the film with states at rest, no trace of
// the start, and what a velocity means to them.
#include "film/use/condensed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "film/compliant_cases.hpp"
#include "film/content_cases.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/film/contract/describe.hpp"

namespace whirl::film::testing {
namespace {

// A film with states, a motion that it can stand, and whether its force has kinks.
struct Case {
  std::string name;
  Geometry geometry;
  Options options;
  JournalMotion motion;
  bool kinked;
  [[nodiscard]] std::unique_ptr<Film> film() const { return make_film(geometry, options, oil()); }
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const CompliantCase& c : compliant_films())
    // Simpson's rule counts whole nodes: its force has kinks.
    all.push_back({c.name, cylinder(), c.options, kMoving, c.options.quadrature == Compliant::Quadrature::simpson});
  for (const ContentCase& c : content_films())
    all.push_back({c.name, c.geometry, c.options, motion(c.geometry, c.position, c.velocity, kSpeed), true});
  return all;
}

class CondensedFilm : public ::testing::TestWithParam<Case> {};

double load_of(const Response& r) {
  return std::hypot(r.force[0], r.force[1]);
}

JournalMotion moved(const Case& c, int direction, double e) {
  JournalMotion m = c.motion;
  const double step = step_of(c.geometry, direction, e);
  if (direction == 8)
    m.speed += step;
  else
    (direction < 4 ? m.position : m.velocity)[static_cast<std::size_t>(direction % 4)] += step;
  return m;
}

// |F(s + e d) - F(s) - e dF d| must fall as e^2 along every port, its rate and the speed.
TEST_P(CondensedFilm, TaylorRemainderIsSecondOrder) {
  const Case& c = GetParam();
  Condensed film(c.film());
  const Response at = evaluate(film, c.motion);
  const auto ports = c.film()->ports();
  std::vector<int> directions = {8};
  for (const Port p : ports) {
    directions.push_back(static_cast<int>(p));
    directions.push_back(4 + static_cast<int>(p));
  }
  for (const int direction : directions) {
    const auto j = static_cast<std::size_t>(direction % 4);
    std::array<double, 2> remainder{};
    double change = 0.0;
    for (std::size_t half = 0; half < 2; ++half) {
      const double e = (c.kinked ? 2e-5 : 2e-3) * (half == 0 ? 1.0 : 0.5), step = step_of(c.geometry, direction, e);
      const Response there = evaluate(film, moved(c, direction, e), Need::force);
      for (const Port p : ports) {
        const auto i = static_cast<std::size_t>(p);
        const double slope = direction == 8  ? at.d_speed[i]
                             : direction < 4 ? at.d_position[i][j]
                                             : at.d_velocity[i][j],
                     size = i < 2 ? 1.0 : 1.0 / c.geometry.length;
        remainder[half] += std::abs(there.force[i] - at.force[i] - slope * step) * size;
        if (half == 1) change += std::abs(slope * step) * size;
      }
    }
    EXPECT_GT(change, 0.0) << direction;
    if (remainder[1] < 1e-11 * load_of(at)) continue;  // linear up to rounding
    EXPECT_GE(std::log2(remainder[0] / remainder[1]), 1.85) << "direction " << direction;
    EXPECT_LT(remainder[1], 0.2 * change) << "direction " << direction;
  }
}

// At rest it is the film with states: force, stiffness, the derivative in the speed, reports.
TEST_P(CondensedFilm, IsTheFilmWithStatesAtRest) {
  const Case& c = GetParam();
  JournalMotion still = c.motion;
  still.velocity = {};
  const auto dynamic = c.film();
  std::vector<double> s(dynamic->states());
  dynamic->unloaded(still, s);
  relax(*dynamic, still, s);
  StateResponse r;
  dynamic->evaluate(still, s, std::vector<double>(s.size(), 0.0), Need::tangents, r);
  const Eliminated expected = eliminate(*dynamic, r);
  Condensed film(c.film());
  const Response found = evaluate(film, still);
  double stiffness = 0.0;
  for (const auto& row : expected.d_position)
    for (const double k : row) stiffness = std::max(stiffness, std::abs(k));
  const double load = load_of(r.journal);
  EXPECT_GT(load, 0.0);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(found.force[i], r.journal.force[i], 1e-10 * load);
    for (std::size_t j = 0; j < 2; ++j)
      EXPECT_NEAR(found.d_position[i][j], expected.d_position[i][j], 1e-10 * stiffness);
    EXPECT_NEAR(found.d_speed[i], expected.d_speed[i], 1e-10 * load / kSpeed);
  }
  EXPECT_NEAR(film.least_thickness(still, {}), dynamic->least_thickness(still, s), 1e-10 * c.geometry.clearance);
  EXPECT_NEAR(film.summary(still, {}).max_pressure, dynamic->summary(still, s).max_pressure,
              1e-9 * dynamic->summary(still, s).max_pressure);
  EXPECT_EQ(film.fields(still, {}).size(), dynamic->fields(still, s).size());
}

// Whatever was asked before: not in the force, and in the tangents no more than a film leaves in them that ends by its
// own tangents (Steady).
TEST_P(CondensedFilm, TheStartDoesNotShow) {
  const Case& c = GetParam();
  Condensed fresh(c.film());
  const Response expected = evaluate(fresh, c.motion);
  double stiffness = 0.0;
  for (const auto& row : expected.d_position)
    for (const double k : row) stiffness = std::max(stiffness, std::abs(k));
  for (const std::array<double, 2> from : {std::array{-0.3, 0.2}, {0.0, 0.0}, {0.21, -0.39}, {0.1, -0.7}}) {
    Condensed film(c.film());
    JournalMotion before = c.motion;
    before.position[0] = from[0] * c.geometry.clearance;
    before.position[1] = from[1] * c.geometry.clearance;
    before.velocity = {};
    before.speed = 0.6 * kSpeed;
    evaluate(film, before, Need::force);
    const Response found = evaluate(film, c.motion);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(found.force[i], expected.force[i], 1e-12 * load_of(expected));
      for (std::size_t j = 0; j < 2; ++j)
        EXPECT_NEAR(found.d_position[i][j], expected.d_position[i][j], 1e-7 * stiffness);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Films, CondensedFilm, ::testing::ValuesIn(cases()),
                         [](const auto& which) { return which.param.name; });

// The condensed film that conserves its mass has a solver of its own: two ways to the same force and tangents, in
// motion.
TEST(Condensed, ContentsThatDoNotChangeAreTheCondensedFilm) {
  for (const ContentCase& c : content_films()) {
    Condensed film(make_film(c.geometry, c.options, oil()));
    const auto own = make_film(c.geometry, without_states(c.options), oil());
    const JournalMotion m = motion(c.geometry, c.position, c.velocity, kSpeed);
    const Response a = evaluate(film, m), b = evaluate(*own, m);
    const std::size_t components = c.options.tilt ? 4 : 2;
    const auto near = [&](const auto& x, const auto& y, const char* what) {
      double size = 0.0;
      for (std::size_t i = 0; i < components; ++i)
        for (std::size_t j = 0; j < components; ++j) size = std::max(size, std::abs(y[i][j]));
      for (std::size_t i = 0; i < components; ++i)
        for (std::size_t j = 0; j < components; ++j)
          EXPECT_NEAR(x[i][j], y[i][j], 1e-9 * size) << c.name << " " << what << i << j;
    };
    near(a.d_position, b.d_position, "position");
    near(a.d_velocity, b.d_velocity, "velocity");
    for (std::size_t i = 0; i < components; ++i) {
      EXPECT_NEAR(a.force[i], b.force[i], 1e-10 * load_of(b)) << c.name;
      EXPECT_NEAR(a.d_speed[i], b.d_speed[i], 1e-9 * load_of(b) / kSpeed) << c.name;
    }
  }
}

// A journal that moves on: few factorisations, as the last set of full nodes is nearly the next one.
TEST(Condensed, AMovingJournalCostsFewFactorisations) {
  Condensed film(make_film(arc(), dynamic({60, 16}), oil()));
  const auto at = [](double angle) {
    return motion(arc(), {0.3 * std::sin(angle), -0.5 + 0.1 * std::cos(angle), 0.0, 0.0},
                  {0.05 * std::cos(angle), -0.02 * std::sin(angle), 0.0, 0.0}, kSpeed);
  };
  evaluate(film, at(0.0));
  for (int k = 1; k < 60; ++k) {
    const long before = film.factorisations();
    evaluate(film, at(0.05 * k));
    EXPECT_LE(film.factorisations() - before, 10) << k;
    EXPECT_GE(film.factorisations() - before, 1) << k;
  }
}

// Over a liner that hardly gives way the film is the rigid one, in damping too: the squeeze of the journal is that of
// the gap.
TEST(Condensed, AStiffLinerIsARigidBore) {
  const JournalMotion m = motion(cylinder(), {0.2, -0.4, 0.0, 0.0}, {0.03, -0.05, 0.0, 0.0}, kSpeed);
  const auto rigid_film = make_film(cylinder(), Short{}, oil());
  const Response rigid = evaluate(*rigid_film, m);
  const auto difference = [&](double compliance) {
    CompliantShort o;
    o.states = States::condensed;
    o.compliance = compliance;
    o.reference_speed = 300.0;
    o.cells = {400, 4};
    o.differences = Compliant::Differences::central;
    const auto film = make_film(cylinder(), o, oil());
    const Response r = evaluate(*film, m);
    double force = 0.0, damping = 0.0, size = 0.0;
    for (std::size_t i = 0; i < 2; ++i) {
      force += std::abs(r.force[i] - rigid.force[i]) / load_of(rigid);
      for (std::size_t j = 0; j < 2; ++j) {
        damping += std::abs(r.d_velocity[i][j] - rigid.d_velocity[i][j]);
        size += std::abs(rigid.d_velocity[i][j]);
      }
    }
    return std::max(force, damping / size);
  };
  const double soft = difference(1e-2), stiff = difference(1e-3);
  EXPECT_LT(stiff, 0.01);
  EXPECT_GT(soft, 4.0 * stiff);
}

// Deep in a liner, beyond the clearance, where a film that carries nothing does not exist.
TEST(Condensed, AJournalBeyondTheClearance) {
  CompliantShort o;
  o.states = States::condensed;
  o.compliance = 1.0;
  o.reference_speed = 300.0;
  o.cells = {60, 4};
  o.differences = Compliant::Differences::third_order;  // central ones waver so deep
  const JournalMotion deep = motion(cylinder(), {0.0, -1.2, 0.0, 0.0}, {}, kSpeed);
  const auto direct = make_film(cylinder(), o, oil()), walked = make_film(cylinder(), o, oil());
  for (const double e : {0.5, 0.8, 0.95, 1.0}) evaluate(*walked, motion(cylinder(), {0.0, -e, 0.0, 0.0}, {}, kSpeed));
  const Response a = evaluate(*direct, deep), b = evaluate(*walked, deep);
  EXPECT_GT(a.force[1], 0.0);
  EXPECT_GT(a.min_thickness, 0.0);
  EXPECT_DOUBLE_EQ(direct->least_thickness(deep, {}), a.min_thickness);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(a.force[i], b.force[i], 1e-12 * load_of(a));
}

// After a motion that it cannot stand the film goes on from where it was.
TEST(Condensed, RecoversFromContact) {
  const ContentCase c = content_films().front();
  Condensed film(make_film(c.geometry, c.options, oil()));
  const JournalMotion m = motion(c.geometry, c.position, {}, kSpeed);
  const Response before = evaluate(film, m);
  JournalMotion touching = m;
  touching.position[1] = -3.0 * c.geometry.clearance;
  Response r;
  EXPECT_THROW(film.evaluate(touching, Need::force, r), core::DomainError);
  const Response after = evaluate(film, m);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(after.force[i], before.force[i], 1e-12 * load_of(before));
}

TEST(Condensed, ADeckChoosesIt) {
  const auto read = [](const char* text) {
    deck::Problems problems;
    const auto o = deck::read<Options>(deck::parse_yaml(text, "d.yaml"), deck::Files(MPI_COMM_SELF), problems);
    return std::pair{o, problems.size()};
  };
  const auto [soft, none] =
      read("{type: compliant_finite, states: condensed, cells: [20, 8], compliance: 0.1, reference_speed: 300 rad/s}");
  EXPECT_EQ(none, 0U);
  EXPECT_TRUE(facts(soft).gives_way);
  EXPECT_EQ(facts(soft).states, 0);
  EXPECT_EQ(make_film(cylinder(), soft, oil())->states(), 0U);
  EXPECT_EQ(read("{type: compliant_short, states: condensed, compliance: 0.1, reference_speed: 300 rad/s, "
                 "liner_damping: 1 ms}")
                .second,
            1U)
      << "a liner whose deflection stands still has no rate to damp";
}

}  // namespace
}  // namespace whirl::film::testing
