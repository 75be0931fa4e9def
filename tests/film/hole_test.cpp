// Round supply holes: a closed form, the balance of oil, symmetry, and where holes may not be.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>

#include "film/cases.hpp"
#include "film/content_cases.hpp"
#include "film/sheet/hole.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

Reynolds conserving(std::array<int, 2> cells) {
  Reynolds o;
  o.cavitation = Reynolds::Cavitation::mass_conserving;
  o.cells = cells;
  return o;
}

// Oil under p_0 in a hole of radius r in the middle of a square of half width a, with p = 0 on its border and a
// constant gap h. Near the hole p is a logarithm. The square is the image of the disc of radius rho = a 2
// sqrt(2)/(2.6220575...), so that p = p_0 ln(rho/s)/ln(rho/r) at the distance s from the middle but for terms of
// (s/rho)^4, which change the flow by (r/rho)^8. Between a source and the load that it carries stands the torsion
// function of the square, -w'' = 1:
//   Q = 2 pi h^3 p_0/(12 mu ln(rho/r)),   int p dA = 12 mu Q/h^3 (w(0) - r^2/4),   w(0) = 0.29468541 a^2
struct Square {
  double a = 0.01, r = 0.0025, p = 3e5, h = 1e-4;
  [[nodiscard]] double flow() const {
    return 2.0 * std::numbers::pi * h * h * h * p / (12.0 * oil().viscosity * std::log(1.0787052 * a / r));
  }
  [[nodiscard]] double load() const {
    return 12.0 * oil().viscosity * flow() / (h * h * h) * (0.29468541 * a * a - 0.25 * r * r);
  }
};

TEST(Hole, FeedsAWideGapAsTheLogarithmSays) {
  const Square exact;
  Geometry g;
  g.radius = 1.0;
  g.length = g.arc = 2.0 * exact.a;  // the pad is nearly plane: cos(0.01) = 1 - 5e-5
  g.clearance = exact.h;
  std::array<double, 4> flow{}, load{};
  for (std::size_t level = 0; level < 4; ++level) {
    const int n = 20 << level;
    Reynolds o = conserving({n, n});
    o.holes = {{270.0 * kDegree, 0.0, 2.0 * exact.r, exact.p}};
    auto film = make_film(g, o, oil());
    const JournalMotion rest;
    const FilmReport s = film->summary(rest, {});
    ASSERT_EQ(s.hole_flows.size(), 1U);
    EXPECT_LT(std::abs(s.imbalance), 1e-12 * s.hole_flows[0]);
    flow[level] = std::abs(s.hole_flows[0] / exact.flow() - 1.0);
    load[level] = std::abs(evaluate(*film, rest).force[1] / exact.load() - 1.0);
    RecordProperty("errors_" + std::to_string(n), std::to_string(flow[level]) + " " + std::to_string(load[level]));
  }
  EXPECT_LT(flow[3], 2e-4);
  EXPECT_LT(load[3], 2e-4);
  EXPECT_GT(std::log2(flow[0] / flow[3]) / 3.0, 1.9) << flow[0] << " " << flow[1] << " " << flow[2] << " " << flow[3];
  EXPECT_GT(std::log2(load[0] / load[3]) / 3.0, 1.9) << load[0] << " " << load[1] << " " << load[2] << " " << load[3];
}

// What holes, edges and grooves give leaves by the sides, to rounding, in whatever motion, with states and without.
TEST(Hole, FlowsBalance) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Reynolds one = conserving({48, 12}), two = conserving({40, 16}), pads = conserving({40, 10});
  one.holes = {{95.0 * kDegree, 0.01, 0.02, 2e5}};
  two.grooves = {{90.0 * kDegree, 10.0 * kDegree, 1e5}};
  two.holes = {{200.0 * kDegree, -0.015, 0.018, 3e5}, {-40.0 * kDegree, 0.01, 0.02, 0.0}};
  pads.tilt = true;
  pads.edge_fill = 0.7;
  pads.holes = {{230.0 * kDegree, 0.05, 0.1, 2e5}, {60.0 * kDegree, -0.06, 0.1, 1e5}};
  for (const auto& [g, o] : {std::pair{cylinder(), one}, {cylinder(), two}, {lemon(), pads}}) {
    auto film = make_film(g, o, oil());
    for (int sample = 0; sample < 10; ++sample) {
      const double tilt = o.tilt ? 0.3 : 0.0;
      const JournalMotion m =
          motion(g, {0.5 * uniform(engine), 0.5 * uniform(engine), tilt * uniform(engine), tilt * uniform(engine)},
                 {0.3 * uniform(engine), 0.3 * uniform(engine), 0.0, 0.0}, sample % 3 == 0 ? -377.0 : 377.0);
      const FilmReport s = film->summary(m, {});
      ASSERT_EQ(s.hole_flows.size(), o.holes.size());
      double size = std::abs(s.side_flow);
      for (const double flow : s.hole_flows) size += std::abs(flow);
      EXPECT_GT(size, 0.0);
      EXPECT_LT(std::abs(s.imbalance), 1e-11 * size);
      EXPECT_GT(std::abs(s.hole_flows[0]), 1e-3 * size) << "the hole feeds";
    }
  }
}

// Around a whole circle a row of nodes beside the holes can be in the cavity as a whole while the rupture is sought:
// those equations are singular. Fed under pressure no row is in the end, wherever the journal is.
TEST(Hole, AloneFeedsTheWholeLength) {
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const auto& cells : {std::array{48, 12}, {24, 30}}) {
    Reynolds o = conserving(cells);
    o.holes = {{-90.0 * kDegree, 0.0, 0.02, 1e5}};
    auto film = make_film(cylinder(), o, oil());
    for (int sample = 0; sample < 250; ++sample) {
      const JournalMotion m =
          motion(cylinder(), {0.65 * uniform(engine), 0.65 * uniform(engine), 0.0, 0.0},
                 {0.4 * uniform(engine), 0.4 * uniform(engine), 0.0, 0.0}, sample % 3 ? 377.0 : -377.0);
      const FilmReport s = film->summary(m, {});
      EXPECT_LT(std::abs(s.imbalance), 1e-9 * s.side_flow) << sample;
      EXPECT_TRUE(std::isfinite(evaluate(*film, m).force[0])) << sample;
    }
  }
}

// Where the gap widens behind a hole without pressure nothing is fed. Said aloud, and forgotten at the next place.
TEST(Hole, WithoutPressureTheFilmRunsDry) {
  Reynolds o = conserving({48, 12});
  o.holes = {{-90.0 * kDegree, 0.0, 0.02, 0.0}};
  auto film = make_film(cylinder(), o, oil()), fresh = make_film(cylinder(), o, oil());
  const JournalMotion least = motion(cylinder(), {0.0, -0.5, 0.0, 0.0}, {}, 377.0),
                      widest = motion(cylinder(), {0.0, 0.5, 0.0, 0.0}, {}, 377.0);
  EXPECT_THROW((void)evaluate(*film, least), core::DomainError);
  EXPECT_THROW((void)film->summary(least, {}), core::DomainError);
  const Response a = evaluate(*film, widest), b = evaluate(*fresh, widest);
  EXPECT_LT(a.force[1], -1000.0);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(a.force[i], b.force[i], 1e-9 * std::abs(b.force[1]));
  EXPECT_EQ(facts(o, cylinder()).misplaced.option, "holes");
  o.holes.push_back({90.0 * kDegree, 0.0, 0.02, 1e4});
  EXPECT_TRUE(facts(o, cylinder()).misplaced.option.empty());
  EXPECT_GT(std::abs(evaluate(*make_film(cylinder(), o, oil()), least).force[1]), 0.0);
}

// Two rims cut the same faces: what is left between them conducts. Along z a square of 16 cells has faces of 1.25 mm;
// of the one between z = 0 and 1.25 mm the holes leave the way from 0.5 to 1 mm, in the columns that meet both middles.
TEST(Hole, BesideAnotherSharesItsFaces) {
  Geometry g;
  g.radius = 1.0;
  g.length = g.arc = 0.02;
  g.clearance = 1e-4;
  Reynolds o = conserving({16, 16});
  o.holes = {{270.0 * kDegree, -0.0015, 0.004, 1e5}, {270.0 * kDegree, 0.003, 0.004, 0.0}};
  ASSERT_FALSE(misplaced_hole(o, g));
  const Pad pad = make_pads(g, o.inlet).front();
  int shared = 0;
  std::set<std::pair<int, int>> met;
  const HoleMesh both(pad, Grid(pad, o.cells), o.holes);
  for (const HoleMesh::Cut& cut : both.along()) {
    EXPECT_TRUE(met.emplace(cut.i, cut.j).second) << "a face counts once";
    if (cut.i != 8 || both.at(cut.i, cut.j - 1) != 1 || both.at(cut.i, cut.j) != 2) continue;
    ++shared;
    EXPECT_NEAR(cut.longer, 1.25 / 0.5, 1e-9);
  }
  EXPECT_EQ(shared, 1);
}

// A film with states of its own that has settled is the one without.
TEST(Hole, WithStatesAndWithout) {
  Reynolds o = dynamic({40, 16});
  EXPECT_THROW((void)make_film(
                   cylinder(),
                   [&] {
                     Reynolds alone = o;
                     alone.holes = {{95.0 * kDegree, 0.01, 0.018, 3e5}};
                     return alone;
                   }(),
                   oil()),
               core::InputError);
  o.grooves = {{-60.0 * kDegree, 0.0, 0.0}};
  o.holes = {{95.0 * kDegree, 0.01, 0.018, 3e5}};
  const JournalMotion m = motion(cylinder(), {0.3, -0.5, 0.0, 0.0}, {0.05, 0.1, 0.0, 0.0}, 377.0);
  auto film = make_film(cylinder(), o, oil());
  const std::vector<double> q = settled(*film, m), rest(q.size(), 0.0);
  StateResponse a;
  film->evaluate(m, q, rest, Need::force, a);
  auto without = make_film(cylinder(), without_states(o), oil());
  const Response b = evaluate(*without, m);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(a.journal.force[i], b.force[i], 1e-9 * std::abs(b.force[1]));
  EXPECT_NEAR(film->summary(m, q).hole_flows.at(0), without->summary(m, {}).hole_flows.at(0),
              1e-9 * without->summary(m, {}).side_flow);
}

// Mirrored at the mid-plane a hole off the middle gives the same force and the opposite moment.
TEST(Hole, OffTheMiddleTheFilmIsNotSymmetric) {
  std::array<Response, 2> r;
  for (const int side : {0, 1}) {
    Reynolds o = conserving({48, 14});
    o.tilt = true;
    o.grooves = {{90.0 * kDegree, 0.0, 0.0}};
    o.holes = {{250.0 * kDegree, side == 0 ? 0.02 : -0.02, 0.02, 4e5}};
    auto film = make_film(cylinder(), o, oil());
    r[static_cast<std::size_t>(side)] =
        evaluate(*film, motion(cylinder(), {0.2, -0.3, 0.0, 0.0}, {0.0, 0.1, 0.0, 0.0}, 377.0));
  }
  const double size = std::abs(r[0].force[1]);
  for (const std::size_t i : {0U, 1U}) EXPECT_NEAR(r[0].force[i], r[1].force[i], 1e-9 * size);
  for (const std::size_t i : {2U, 3U}) EXPECT_NEAR(r[0].force[i], -r[1].force[i], 1e-9 * size * cylinder().length);
  EXPECT_GT(std::abs(r[0].force[3]), 1e-3 * size * cylinder().length);
}

// A hole under no pressure holds p = 0 there, whatever happens to the rest.
TEST(Hole, HoldsItsPressureInEveryFilm) {
  using enum Reynolds::Cavitation;
  for (const auto cavitation : {half_sommerfeld, reynolds, none, mass_conserving}) {
    Reynolds o = conserving({48, 12});
    o.cavitation = cavitation;
    o.holes = {{-70.0 * kDegree, 0.0, 0.02, cavitation == mass_conserving ? 1e5 : 0.0}};
    auto film = make_film(cylinder(), o, oil());
    const JournalMotion m = motion(cylinder(), {0.0, -0.6, 0.0, 0.0}, {}, 377.0);
    const auto fields = film->fields(m, {});
    int held = 0;
    double highest = 0.0;
    for (const NodalField& f : fields) {
      if (f.name != "pressure") continue;
      for (int i = 0; i < 48; ++i)
        for (int j = 0; j <= 12; ++j) {
          const double theta = 90.0 * kDegree + i * 7.5 * kDegree, z = cylinder().length * (j / 12.0 - 0.5);
          const double p = f.values[static_cast<std::size_t>(i * 13 + j)];
          highest = std::max(highest, p);
          if (std::hypot(cylinder().radius * std::remainder(theta + 70.0 * kDegree, 2.0 * std::numbers::pi), z) > 0.01)
            continue;
          ++held;
          EXPECT_NEAR(p, o.holes[0].pressure, 1e-9 * 1e5);
        }
    }
    EXPECT_GE(held, 5);
    EXPECT_GT(highest, 2e5) << "the film around it carries";
  }
}

TEST(Hole, MayNotBeAnywhere) {
  const auto why = [](const Geometry& g, const std::vector<Hole>& holes, std::vector<Groove> grooves = {}) {
    Reynolds o = conserving({48, 12});
    o.holes = holes;
    o.grooves = std::move(grooves);
    const auto found = misplaced_hole(o, g);
    return found ? std::to_string(found->hole + 1) + ": " + found->reason : "";
  };
  const Hole good{270.0 * kDegree, 0.0, 0.02, 1e5};
  EXPECT_EQ(why(cylinder(), {good}, {{90.0 * kDegree, 0.2, 0.0}}), "");
  EXPECT_NE(why(cylinder(), {good, {270.0 * kDegree, 0.035, 0.02, 1e5}}).find("2: the hole reaches over a side"),
            std::string::npos);
  EXPECT_NE(why(cylinder(), {good, {285.0 * kDegree, 0.0, 0.02, 1e5}}).find("2: the hole overlaps hole 1"),
            std::string::npos);
  EXPECT_NE(why(cylinder(), {good}, {{260.0 * kDegree, 0.1, 0.0}}).find("1: the hole overlaps groove 1"),
            std::string::npos);
  // The groove has no width, but holds the node at 90 deg, which lies in the hole.
  EXPECT_NE(why(cylinder(), {{90.0 * kDegree, 0.0, 0.004, 1e5}}, {{86.5 * kDegree, 0.0, 0.0}})
                .find("1: the hole overlaps groove 1, whose edges are moved to the nearest nodes"),
            std::string::npos);
  EXPECT_EQ(why(cylinder(), {{90.0 * kDegree, 0.0, 0.004, 1e5}}, {{84.0 * kDegree, 0.0, 0.0}}), "");
  EXPECT_NE(why(arc(), {{200.0 * kDegree, 0.0, 0.02, 1e5}}).find("1: the hole does not lie on a pad"),
            std::string::npos);
  EXPECT_NE(why(arc(), {{241.0 * kDegree, 0.0, 0.02, 1e5}}).find("1: the hole does not lie on a pad"),
            std::string::npos);
  EXPECT_NE(why(cylinder(), {{272.0 * kDegree, 0.003, 0.001, 1e5}}).find("no node of the mesh"), std::string::npos);
  Reynolds o = conserving({48, 12});
  o.holes = {{272.0 * kDegree, 0.003, 0.001, 1e5}};
  EXPECT_THROW((void)make_film(cylinder(), o, oil()), core::InputError);
}

}  // namespace
}  // namespace whirl::film::testing
