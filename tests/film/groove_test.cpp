// Axial grooves of compliant films.
#include <gtest/gtest.h>

#include <cmath>

#include "film/compliant_cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

constexpr Groove kTop{90.0 * kDegree, 0.0};

using enum Kind;

TEST(Groove, OneAtTheTopIsTheInletOfTheLongFilm) {
  Elastic plain = compliant(compliant_long, 0.1, 40, false), grooved = plain;
  grooved.grooves = {kTop};
  auto a = make_film(cylinder(), plain, oil()), b = make_film(cylinder(), grooved, oil());
  ASSERT_EQ(a->states(), b->states());
  EXPECT_EQ(relaxed(*a, still(0.3, -0.4)), relaxed(*b, still(0.3, -0.4)));
}

// A finite film keeps the lines in a groove; it tends to the long one with the same groove as L/D grows.
TEST(Groove, FiniteFilmTendsToTheLongOne) {
  const auto away = [](double ld, int along) {
    Geometry g = cylinder();
    g.length = 2.0 * g.radius * ld;
    Elastic lines = compliant(compliant_finite, 1e-2, 48, false), whole = compliant(compliant_long, 1e-2, 48, false);
    lines.cells[1] = along;
    lines.grooves = {kTop};
    const JournalMotion m = motion(g, {0.3, -0.3, 0.0, 0.0}, {}, kSpeed);
    std::array<std::array<double, 4>, 2> f{};
    for (const auto& [k, o] : {std::pair{0U, lines}, {1U, whole}}) {
      auto film = make_film(g, o, oil());
      const auto s = relaxed(*film, m);
      StateResponse r;
      film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::force, r);
      f[k] = r.journal.force;
    }
    return std::hypot(f[0][0] - f[1][0], f[0][1] - f[1][1]) / std::hypot(f[1][0], f[1][1]);
  };
  const double a = away(8.0, 60), b = away(16.0, 120);
  EXPECT_LT(b, 0.09);
  EXPECT_NEAR(std::log2(a / b), 1.0, 0.2);
}

// Edges on nodes of every mesh.
TEST(Groove, StaticForceIsOfSecondOrder) {
  for (const auto kind : {compliant_short, compliant_long, compliant_finite}) {
    std::array<std::array<double, 4>, 4> f{};
    for (std::size_t k = 0; k < 4; ++k) {
      Elastic o = compliant(kind, 0.1, 36 << k, false);
      o.cells[1] = 4 << k;
      if (kind == compliant_finite && k == 3) continue;
      o.grooves = {{90.0 * kDegree, 20.0 * kDegree}, {-30.0 * kDegree, 20.0 * kDegree}};
      f[k] = static_response(o, still(0.3, -0.3)).force;
    }
    const auto change = [&](std::size_t k) { return std::hypot(f[k + 1][0] - f[k][0], f[k + 1][1] - f[k][1]); };
    const std::size_t first = kind == compliant_finite ? 0 : 1;
    EXPECT_GT(std::log2(change(first) / change(first + 1)), 1.6) << static_cast<int>(kind);
  }
}

// The mirror image of the bearing, turning the other way, carries the mirror image of the force.
TEST(Groove, MirrorImages) {
  for (const auto kind : {compliant_short, compliant_long, compliant_finite}) {
    Elastic left = compliant(kind, 0.1, 36, false), right = left;
    left.grooves = {{150.0 * kDegree, 20.0 * kDegree}};
    right.grooves = {{30.0 * kDegree, 20.0 * kDegree}};
    const Geometry g = cylinder();
    const Response a = static_response(left, motion(g, {0.2, -0.5, 0.0, 0.0}, {}, 377.0)),
                   b = static_response(right, motion(g, {-0.2, -0.5, 0.0, 0.0}, {}, -377.0));
    EXPECT_NEAR(a.force[0], -b.force[0], 1e-8 * std::abs(a.force[1]));
    EXPECT_NEAR(a.force[1], b.force[1], 1e-8 * std::abs(a.force[1]));
  }
}

// Without pressure in a groove its lines of a finite film follow the journal, however they are moved.
TEST(Groove, LinesOfAFiniteFilmFollowTheJournal) {
  Elastic o = compliant(compliant_finite, 0.1, 36, false);
  o.grooves = {{90.0 * kDegree, 20.0 * kDegree}};
  auto film = make_film(cylinder(), o, oil());
  const JournalMotion m = motion(cylinder(), {0.3, -0.3, 0.0, 0.0}, {0.2, 0.1, 0.0, 0.0}, kSpeed);
  const auto s = relaxed(*film, still(0.3, -0.3));
  std::vector<double> rates(s.size(), 0.0);
  StateResponse r;
  film->evaluate(m, s, rates, Need::force, r);
  const auto states = static_cast<std::size_t>(o.cells[1] - 1);  // of a line
  for (const std::size_t line : {0U, 1U, 35U})
    for (std::size_t j = 0; j < states; ++j) {
      const double theta = 90.0 * kDegree + 10.0 * kDegree * static_cast<double>(line);
      const double away = m.velocity[0] * std::cos(theta) + m.velocity[1] * std::sin(theta);
      EXPECT_NEAR(r.residual[line * states + j], away, 1e-9 * scale_of(*film) * kSpeed);
    }
}

}  // namespace
}  // namespace whirl::film::testing
