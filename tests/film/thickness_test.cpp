// Least film thickness.
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "film/cases.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/sheet/thickness.hpp"

namespace whirl::film::testing {
namespace {

// Least of a million places of the formula of the room's page.
double sampled(const Geometry& g, const std::array<double, 4>& at) {
  const bool lobes = g.type == Geometry::Bore::lemon_bore;
  const double machined = g.clearance / (1.0 - g.preload), half = 0.5 * g.arc;
  double least = std::numeric_limits<double>::infinity();
  for (int pad = 0; pad < (lobes ? 2 : 1); ++pad) {
    const double side = pad == 0 ? 1.0 : -1.0, middle = pad == 0 ? 1.5 * std::numbers::pi : 0.5 * std::numbers::pi;
    constexpr int n = 200000;
    for (int i = 0; i <= n; ++i)
      for (const double z : {-0.5 * g.length, 0.0, 0.5 * g.length}) {
        const double extent = g.type == Geometry::Bore::cylindrical ? std::numbers::pi : half;
        const double theta = middle + extent * (2.0 * i / n - 1.0);
        const double x = at[0] + z * at[2] - side * 0.5 * g.offset,
                     y = at[1] + z * at[3] - side * (machined - g.clearance);
        least = std::min(least, machined - x * std::cos(theta) - y * std::sin(theta));
      }
  }
  return least;
}

TEST(Thickness, LeastIsThatOfTheFormula) {
  Geometry offset = lemon();
  offset.offset = 0.4 * offset.clearance;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.7, 0.7);
  for (const Geometry& g : {lemon(), offset, arc(), cylinder()})
    for (int k = 0; k < 8; ++k) {
      const JournalMotion m =
          motion(g, {uniform(random), uniform(random), 0.3 * uniform(random), 0.3 * uniform(random)}, {}, 1.0);
      EXPECT_NEAR(minimum_thickness(g, m.position), sampled(g, m.position), 1e-9 * g.clearance);
      if (g.type == Geometry::Bore::partial_arc) continue;  // its thinnest place may be far from the journal
      Reynolds o;
      o.tilt = true;
      o.cells = {12, 4};
      EXPECT_DOUBLE_EQ(evaluate(*make_film(g, o, oil()), m, Need::force).min_thickness,
                       minimum_thickness(g, m.position));
    }
}

// Between two nodes of a coarse mesh the journal is through the wall: nodes alone would not see it.
TEST(Thickness, ContactBetweenNodesIsSeen) {
  for (const auto cavitation : {Reynolds::Cavitation::half_sommerfeld, Reynolds::Cavitation::reynolds})
    for (const Geometry& g : {arc(), cylinder()}) {
      Reynolds o;
      o.cavitation = cavitation;
      o.cells = {9, 4};
      auto film = make_film(g, o, oil());
      const double between = 270.0 * kDegree + 0.13 * kDegree, e = 1.0 + 1e-6;
      Response r;
      EXPECT_THROW(film->evaluate(motion(g, {e * std::cos(between), e * std::sin(between), 0.0, 0.0}, {}, 377.0),
                                  Need::force, r),
                   core::DomainError);
      EXPECT_LE(
          minimum_thickness(g, {e * g.clearance * std::cos(between), e * g.clearance * std::sin(between), 0.0, 0.0}),
          0.0);
    }
}

}  // namespace
}  // namespace whirl::film::testing
