// Truncation, continuity across rupture, symmetry, agreement of the two solvers, report fields.
#include <gtest/gtest.h>

#include <random>

#include "film/cases.hpp"
#include "whirl/thermal/truncation.hpp"

namespace whirl::film::testing {
namespace {

using thermal::truncated_edge, thermal::truncated_linear;

using C = Reynolds::Cavitation;

double largest(const Response& a, const Response& b, bool tangents) {
  double most = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!tangents) most = std::max(most, std::abs(a.force[i] - b.force[i]));
    for (std::size_t j = 0; tangents && j < 2; ++j) {
      most = std::max(most, std::abs(a.d_position[i][j] - b.d_position[i][j]));
    }
  }
  return most;
}

TEST(Truncation, IntervalIntegralsAreExactAndTheirGradientsConsistent) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr int n = 4000;
  constexpr double e = 1e-6;
  for (int sample = 0; sample < 300; ++sample) {
    const double p = uniform(random), q = uniform(random);
    double line = 0.0;
    for (int i = 0; i < n; ++i) {
      const double s = (i + 0.5) / n;
      line += std::max(0.0, p + s * (q - p)) / n;
    }
    const auto a = truncated_linear(p, q);
    EXPECT_NEAR(a.integral, line, 1e-6);
    EXPECT_NEAR(a.d_left, (truncated_linear(p + e, q).integral - truncated_linear(p - e, q).integral) / (2.0 * e),
                1e-4);
    EXPECT_NEAR(a.d_right, (truncated_linear(p, q + e).integral - truncated_linear(p, q - e).integral) / (2.0 * e),
                1e-4);
    const auto b = truncated_edge(p, q);
    EXPECT_NEAR(b.d_near, (truncated_edge(p + e, q).integral - truncated_edge(p - e, q).integral) / (2.0 * e), 1e-4);
    EXPECT_NEAR(b.d_far, (truncated_edge(p, q + e).integral - truncated_edge(p, q - e).integral) / (2.0 * e), 1e-4);
  }
  EXPECT_EQ(truncated_linear(0.0, 0.0).integral, 0.0);
  EXPECT_EQ(truncated_edge(-0.1, -0.2).integral, 0.0);
  EXPECT_EQ(truncated_edge(0.1, 0.15).integral, 0.05);
  // No kink where rupture passes the first node.
  EXPECT_NEAR(truncated_edge(1e-9, 1.0).d_near, 0.0, 1e-7);
  EXPECT_NEAR(truncated_edge(1e-9, -1.0).d_near, 0.0, 1e-7);
}

// A finely moved journal drags the rupture through many cells: the largest jump of force and tangent between neighbours
// falls with the step (a node-wise truncation would keep finite jumps of the tangent).
TEST(Truncation, ForceAndTangentAreContinuousAcrossAMovingRupture) {
  auto model = make_film(lemon(), {}, oil());
  std::array<double, 2> force{}, tangent{};
  for (std::size_t k = 0; k < 2; ++k) {
    const int steps = k == 0 ? 500 : 8000;
    Response last;
    for (int s = 0; s <= steps; ++s) {
      const double t = static_cast<double>(s) / steps;
      const Response r = evaluate(*model, motion(lemon(), {-0.6 + 1.5 * t, -0.4 + 0.1 * t, 0.0, 0.0}, {}, 377.0));
      if (s > 0) {
        force[k] = std::max(force[k], largest(r, last, false));
        tangent[k] = std::max(tangent[k], largest(r, last, true));
      }
      last = r;
    }
  }
  EXPECT_NEAR(force[0] / force[1], 16.0, 0.3);
  EXPECT_NEAR(tangent[0] / tangent[1], 16.0, 0.3);
}

// Both solvers answer the same discrete equations.
TEST(Solvers, SineModesAndBandAgreeToRounding) {
  for (const C cavitation : {C::half_sommerfeld, C::none}) {
    for (const std::array<int, 2> cells : {std::array<int, 2>{60, 16}, {31, 11}, {50, 40}}) {
      Reynolds modal;
      modal.cells = cells;
      modal.cavitation = cavitation;
      Reynolds band = modal;
      band.tilt = true;
      for (const Geometry& g : {lemon(), arc()}) {
        const JournalMotion m = motion(g, {0.4, -0.5, 0.0, 0.0}, {0.05, -0.08, 0.0, 0.0}, 377.0);
        const Response a = evaluate(*make_film(g, modal, oil()), m), b = evaluate(*make_film(g, band, oil()), m);
        const auto near = [&](const auto& u, const auto& v) {
          double size = 0.0;
          for (std::size_t i = 0; i < 2; ++i) size = std::max({size, std::abs(u[i][0]), std::abs(u[i][1])});
          for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t j = 0; j < 2; ++j) EXPECT_NEAR(u[i][j], v[i][j], 1e-12 * size);
          }
        };
        for (std::size_t i = 0; i < 2; ++i) {
          EXPECT_NEAR(a.force[i], b.force[i], 1e-12 * std::abs(a.force[1]));
          EXPECT_NEAR(b.force[i + 2], 0.0, 1e-12 * std::abs(a.force[1]) * g.length);
          EXPECT_NEAR(a.d_speed[i], b.d_speed[i], 1e-12 * std::abs(a.d_speed[1]));
        }
        near(a.d_position, b.d_position);
        near(a.d_velocity, b.d_velocity);
        EXPECT_DOUBLE_EQ(a.min_thickness, b.min_thickness);
      }
    }
  }
}

// The half pad of an aligned journal and the whole pad have the same cavitated film.
TEST(Solvers, HalfAndWholePadAgreeWithReynoldsCavitation) {
  for (const int rows : {16, 13}) {
    Reynolds half;
    half.cells = {48, rows};
    half.cavitation = C::reynolds;
    Reynolds whole = half;
    whole.tilt = true;
    const JournalMotion m = motion(lemon(), {0.9, -0.4, 0.0, 0.0}, {}, 377.0);
    const Response a = evaluate(*make_film(lemon(), half, oil()), m),
                   b = evaluate(*make_film(lemon(), whole, oil()), m);
    EXPECT_LT(largest(a, b, false), 1e-10 * std::abs(a.force[1]));
    EXPECT_LT(largest(a, b, true), 1e-10 * std::abs(a.d_position[1][1]));
  }
}

// Complementarity makes damping symmetric; truncation after the solution does not.
TEST(Solvers, OnlyComplementarityHasSymmetricDamping) {
  const JournalMotion m = motion(lemon(), {0.9, -0.4, 0.0, 0.0}, {}, 377.0);
  Reynolds o;
  o.cavitation = C::half_sommerfeld;
  Response r = evaluate(*make_film(lemon(), o, oil()), m);
  EXPECT_GT(std::abs(r.d_velocity[0][1] - r.d_velocity[1][0]), 0.1 * std::abs(r.d_velocity[0][1]));
  o.cavitation = C::reynolds;
  r = evaluate(*make_film(lemon(), o, oil()), m);
  EXPECT_NEAR(r.d_velocity[0][1], r.d_velocity[1][0], 1e-10 * std::abs(r.d_velocity[0][1]));
}

TEST(Signs, LoadedJournalIsLiftedAndPushedForward) {
  auto model = make_film(arc(), {}, oil());
  const Response low = evaluate(*model, motion(arc(), {0.0, -0.6, 0.0, 0.0}, {}, 377.0));
  EXPECT_GT(low.force[1], 0.0);
  EXPECT_LT(low.d_position[1][1], 0.0);
  EXPECT_LT(low.d_velocity[0][0], 0.0);
  EXPECT_LT(low.d_velocity[1][1], 0.0);
  Geometry round = arc();
  round.arc = 2.0 * std::numbers::pi;
  const Response r = evaluate(*make_film(round, {}, oil()), motion(round, {0.0, -0.6, 0.0, 0.0}, {}, 377.0));
  EXPECT_GT(r.force[0], 0.0);  // forward whirl: along the rotation, +x at the bottom
}

// In a round bore h turns with the journal: at half speed wedge and squeeze cancel, also on the grid.
TEST(Signs, HalfSpeedWhirlCarriesNoLoad) {
  Reynolds o;
  o.cavitation = C::none;
  auto model = make_film(arc(), o, oil());
  const double still = std::abs(evaluate(*model, motion(arc(), {0.3, -0.5, 0.0, 0.0}, {}, 377.0)).force[1]);
  const Response r = evaluate(*model, motion(arc(), {0.3, -0.5, 0.0, 0.0}, {0.25, 0.15, 0.0, 0.0}, 377.0));
  EXPECT_NEAR(r.force[0], 0.0, 1e-12 * still);
  EXPECT_NEAR(r.force[1], 0.0, 1e-12 * still);
}

TEST(Signs, MirrorAndHalfTurn) {
  Geometry g = lemon();
  auto model = make_film(g, {}, oil());
  const Response a = evaluate(*model, motion(g, {0.5, -0.3, 0.0, 0.0}, {0.05, -0.02, 0.0, 0.0}, 377.0));
  JournalMotion mirrored = motion(g, {-0.5, -0.3, 0.0, 0.0}, {-0.05, -0.02, 0.0, 0.0}, 377.0);
  mirrored.speed = -377.0;
  const Response b = evaluate(*model, mirrored);
  const double tiny = 1e-11 * std::abs(a.force[1]);
  EXPECT_NEAR(a.force[0], -b.force[0], tiny);
  EXPECT_NEAR(a.force[1], b.force[1], tiny);
  EXPECT_NEAR(a.d_speed[0], b.d_speed[0], tiny);
  EXPECT_NEAR(a.d_speed[1], -b.d_speed[1], tiny);
  g.offset = 0.3 * g.clearance;  // an offset bore keeps only its half-turn symmetry
  auto offset = make_film(g, {}, oil());
  const Response c = evaluate(*offset, motion(g, {0.5, -0.3, 0.0, 0.0}, {0.05, -0.02, 0.0, 0.0}, 377.0));
  const Response d = evaluate(*offset, motion(g, {-0.5, 0.3, 0.0, 0.0}, {-0.05, 0.02, 0.0, 0.0}, 377.0));
  EXPECT_NEAR(c.force[0], -d.force[0], tiny);
  EXPECT_NEAR(c.force[1], -d.force[1], tiny);
}

// Offset: the lower lobe moves to +x by half of it, the upper to -x.
TEST(Signs, OffsetMovesTheLowerLobeToTheRight) {
  Geometry g = lemon();
  g.offset = 0.5 * g.clearance;
  const auto fields = make_film(g, {}, oil())->fields(motion(g, {}, {}, 377.0), {});
  for (const NodalField& f : fields) {
    if (f.name != "thickness") continue;
    const std::size_t columns = f.shape[1];
    const double first = f.values.front(), last = f.values[(f.shape[0] - 1) * columns];
    const double change = (last - first) / g.clearance;
    // h = c_p - X cos - Y sin with X = -+offset/2; cos grows by 2 sin(80 deg) across the lower pad, falls across the
    // upper.
    EXPECT_NEAR(change, 0.5 * std::sin(80.0 * kDegree), 1e-12) << "pad " << f.pad;
  }
}

// The force is the integral of the reported pressure, and tilt adds a moment against itself.
TEST(Fields, IntegrateToTheForce) {
  for (const bool tilt : {false, true}) {
    Reynolds o;
    o.tilt = tilt;
    o.cells = {120, 32};
    auto model = make_film(lemon(), o, oil());
    const JournalMotion m = motion(lemon(), {0.9, -0.4, 0.0, tilt ? -0.2 : 0.0}, {}, 377.0);
    const Response r = evaluate(*model, m);
    std::array<double, 3> total{};
    const auto fields = model->fields(m, {});
    ASSERT_EQ(fields.size(), 8u);
    for (std::size_t pad = 0; pad < 2; ++pad) {
      const auto &theta = fields[4 * pad], &z = fields[4 * pad + 1], &p = fields[4 * pad + 2];
      ASSERT_EQ(p.shape, (std::vector<std::size_t>{121, 33}));
      const double area = 0.2 * (theta.values[1] - theta.values[0]) * (z.values[1] - z.values[0]);
      for (std::size_t i = 0; i < 121; ++i) {
        for (std::size_t j = 0; j < 33; ++j) {
          const double f = area * p.values[i * 33 + j];
          total[0] -= f * std::cos(theta.values[i]);
          total[1] -= f * std::sin(theta.values[i]);
          total[2] -= f * std::sin(theta.values[i]) * z.values[j];
        }
      }
    }
    EXPECT_NEAR(total[0], r.force[0], 2e-3 * std::abs(r.force[1]));
    EXPECT_NEAR(total[1], r.force[1], 2e-3 * std::abs(r.force[1]));
    EXPECT_NEAR(total[2], r.force[3], 2e-3 * std::abs(r.force[1]) * 0.36);
    if (tilt) {
      EXPECT_GT(r.force[3], 0.0);
    }
  }
}

}  // namespace
}  // namespace whirl::film::testing
