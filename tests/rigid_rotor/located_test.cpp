// Located bifurcations of a rigid rotor in rigid bearings, through the deck. Reference values: an independent
// computation (exact closed-form force, Gauss collocation on 60-240 intervals) of the cases of van de Vrande (2001),
// sec. 5.2.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include "rigid_rotor/run_deck.hpp"
#include "source_dir.hpp"

namespace {

using namespace whirl;
using Type = io::BifurcationType;

struct Point {
  Type type;
  double speed;      // Omega*
  double tolerance;  // absolute
};
struct Case {
  std::string name, film;
  double load, unbalance;  // F0*, a*
  double from, to;         // Omega*
  std::vector<Point> points;
};

class Located : public ::testing::TestWithParam<Case> {};

io::StudySummary run(const Case& c) {
  // m = 1 kg, c = 25 um and F0* = Omega_0/(160 rad/s) for these bearings.
  const double scale = 160 * c.load;
  const std::string range =
      fmt::format("range={{from: {:.17g} rad/s, to: {:.17g} rad/s}}", c.from * scale, c.to * scale);
  std::vector<std::string> overrides = {
      fmt::format("rotor.load={:.17g} N", 25e-6 * scale * scale), "bearings.left.film.type=" + c.film,
      "bearings.right.film.type=" + c.film,
      c.unbalance > 0 ? "studies.2.cycle_branch." + range : "studies.1.equilibrium_branch." + range};
  if (c.unbalance > 0) {
    overrides.push_back(fmt::format("unbalance.a.planes.1.eccentricity={:.17g} um", 25 * c.unbalance));
    overrides.push_back(
        fmt::format("studies.2.cycle_branch.step={{initial: {0} rad/s, min: {1} rad/s, max: {2} rad/s}}", 0.02 * scale,
                    1e-5 * scale, 0.1 * scale));
  }
  study::Deck deck =
      study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/rigid_rotor/short_f1.yaml", overrides);
  deck.studies.erase(deck.studies.begin() + (c.unbalance > 0 ? 0 : 1));
  return test::run_deck(deck, "located_" + c.name).at(0);
}

TEST_P(Located, AgreesWithTheReference) {
  const Case& c = GetParam();
  const io::StudySummary s = run(c);
  EXPECT_EQ(s.status, "completed");
  auto values = test::values_of(s);
  EXPECT_NEAR(values["nondimensional.load"], c.load, 1e-12);
  EXPECT_NEAR(values["nondimensional.unbalance"], c.unbalance, 1e-12);
  EXPECT_NEAR(values["nondimensional.speed_scale"], 160 * c.load, 1e-9);
  ASSERT_EQ(s.bifurcations.size(), c.points.size());
  for (std::size_t i = 0; i < c.points.size(); ++i) {
    const auto& b = s.bifurcations[i];
    EXPECT_EQ(b.type, c.points[i].type) << i;
    const double speed = b.more.at("nondimensional_speed");
    EXPECT_NEAR(speed, c.points[i].speed, c.points[i].tolerance) << i;
    EXPECT_NEAR(speed, b.value / (160 * c.load), 1e-12);
    EXPECT_NEAR(b.more.at("sommerfeld"), c.load / (2 * speed), 1e-12);
  }
}

INSTANTIATE_TEST_SUITE_P(
    RigidRotor, Located,
    ::testing::Values(
        Case{"short_half_balanced", "short", 0.5, 0, 0.5, 4, {{Type::hopf, 2.75634869, 1e-6}}},
        Case{"short_one_balanced", "short", 1, 0, 0.5, 4, {{Type::hopf, 2.73526314, 1e-6}}},
        Case{"short_two_balanced", "short", 2, 0, 0.5, 4, {{Type::hopf, 2.67117718, 1e-6}}},
        Case{"long_two_balanced", "long", 2, 0, 0.5, 4, {{Type::hopf, 1.97398006, 1e-6}}},
        Case{"long_one_balanced", "long", 1, 0, 0.5, 4, {{Type::hopf, 1.95939819, 1e-6}}},
        Case{"inlet_two_balanced", "long_inlet", 2, 0, 0.2, 1, {{Type::hopf, 0.403868, 2e-6}}},
        Case{"short_one_a1", "short", 1, 0.1, 2, 4, {{Type::flip, 2.468901, 1e-5}, {Type::flip, 3.412566, 1e-5}}},
        Case{"short_one_a2", "short", 1, 0.2, 2, 7, {{Type::flip, 2.874299, 1e-5}, {Type::flip, 5.760622, 1e-5}}},
        Case{"short_one_a3", "short", 1, 0.3, 9, 11, {{Type::neimark_sacker, 10.389171, 1e-5}}},
        Case{"short_half_a1", "short", 0.5, 0.1, 2, 5, {{Type::flip, 2.473685, 1e-5}, {Type::flip, 3.812777, 1e-5}}},
        Case{"short_half_a2", "short", 0.5, 0.2, 8, 11, {{Type::flip, 8.882138, 1e-5}, {Type::flip, 10.054424, 1e-5}}},
        Case{"short_half_a3", "short", 0.5, 0.3, 20, 21, {{Type::neimark_sacker, 20.723192, 1e-5}}},
        Case{"short_two_a1", "short", 2, 0.1, 2, 4, {{Type::flip, 2.485310, 1e-5}, {Type::flip, 3.110053, 1e-5}}},
        Case{"short_two_a2", "short", 2, 0.2, 2, 5, {{Type::flip, 2.396433, 1e-5}, {Type::flip, 3.959917, 1e-5}}},
        Case{"short_two_a3", "short", 2, 0.3, 4, 7, {{Type::flip, 4.695147, 1e-5}, {Type::flip, 6.370272, 1e-5}}},
        Case{"long_two_a1", "long", 2, 0.1, 1.5, 3, {{Type::flip, 1.836718, 1e-5}, {Type::flip, 2.202713, 1e-5}}},
        Case{"long_two_a2", "long", 2, 0.2, 1.5, 4, {{Type::flip, 1.758947, 1e-5}, {Type::flip, 2.757556, 1e-5}}},
        Case{"long_two_a3", "long", 2, 0.3, 1.5, 5, {{Type::flip, 1.761503, 1e-5}, {Type::flip, 3.813564, 1e-5}}}),
    [](const auto& which) { return which.param.name; });

}  // namespace
