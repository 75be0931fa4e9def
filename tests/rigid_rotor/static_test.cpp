// What `static` and `bearing_map` say of films: flows, what has a bar and what is exact.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rigid_rotor/run_deck.hpp"
#include "source_dir.hpp"

namespace {

using namespace whirl;

// Bearings of L/D = 1 as wide as Reynolds' equation has them, at these words for their film.
std::map<std::string, double> values(const std::string& name, const std::string& film, const std::string& study) {
  std::vector<std::string> words{"studies=[{" + study + "}]"};
  for (const std::string bearing : {"left", "right"}) {
    words.push_back("bearings." + bearing + ".film={type: reynolds, turbulence: laminar, cells: [60, 16]" + film + "}");
    words.push_back("bearings." + bearing + ".geometry.length=10 mm");
  }
  study::Deck deck =
      study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/rigid_rotor/short_f1.yaml", words);
  return test::values_of(test::run_deck(deck, "static_" + name).at(0));
}

// q/(R c N L) through the line of maximum gap is pi of a centred journal, 3.37 at eccentricity 0.1, 3.59 at 0.2 and
// 3.99 at 0.4; side flow over q is 0, 0.150, 0.280 and 0.497 (Raimondi and Boyd 1958, L/D = 1).
TEST(Static, FlowsAreThoseOfRaimondiAndBoyd) {
  for (const double speed : {400.0, 1500.0}) {
    const auto v = values("flow", ", cavitation: reynolds, inlet: {type: maximum_gap}",
                          "static: {speed: " + std::to_string(speed) + " rad/s}");
    const double e = std::hypot(v.at("bearing.left.eccentricity.x"), v.at("bearing.left.eccentricity.y")),
                 q = v.at("bearing.left.inlet_flow"), unit = 5e-3 * 25e-6 * 10e-3 * speed / (2 * std::numbers::pi);
    SCOPED_TRACE(e);
    ASSERT_GT(e, 0.02);
    ASSERT_LT(e, 0.4);
    const double a = e < 0.1 ? 0 : e < 0.2 ? 0.1 : 0.2, b = e < 0.1 ? 0.1 : e < 0.2 ? 0.2 : 0.4, s = (e - a) / (b - a);
    const auto q_at = [](double x) { return x == 0 ? std::numbers::pi : x == 0.1 ? 3.37 : x == 0.2 ? 3.59 : 3.99; };
    const auto side_at = [](double x) { return x == 0 ? 0 : x == 0.1 ? 0.150 : x == 0.2 ? 0.280 : 0.497; };
    EXPECT_NEAR(q / unit, (1 - s) * q_at(a) + s * q_at(b), 0.03);
    EXPECT_NEAR(v.at("bearing.left.side_flow") / q, (1 - s) * side_at(a) + s * side_at(b), 0.015);
    EXPECT_GT(v.at("bearing.left.inlet_flow.uncertainty"), 0);
  }
}

// A film that reforms wherever pressure rises has no line at which it starts.
TEST(Static, AFilmWithoutStartHasNoInletFlow) {
  const auto v = values("free", "", "static: {speed: 400 rad/s}");
  EXPECT_EQ(v.count("bearing.left.inlet_flow"), 0U);
  EXPECT_EQ(v.count("bearing.left.side_flow"), 1U);
}

// What the deck gives is exact, whatever meshes say; null as a bar would mean that it is not known.
TEST(ExactValues, HaveNoBar) {
  const auto rest = values("exact", "", "static: {speed: 400 rad/s}");
  EXPECT_EQ(rest.count("bearing.left.minimum_film"), 1U);
  EXPECT_EQ(rest.count("bearing.left.minimum_film.uncertainty"), 0U);
  EXPECT_GT(rest.at("bearing.left.max_pressure.uncertainty"), 0);
  const auto map = values("map", "", "bearing_map: {speed: 400 rad/s, points: 12, grid: 3, sommerfeld: [0.5]}");
  EXPECT_GT(map.at("sommerfeld.0.5.attitude.uncertainty"), 0);
  EXPECT_GT(map.at("threshold.speed.uncertainty"), 0);
  for (const char* name : {"speed_scale", "load", "unbalance", "length_to_diameter", "sommerfeld_times_speed"}) {
    EXPECT_EQ(map.count(std::string("nondimensional.") + name), 1U) << name;
    EXPECT_EQ(map.count(std::string("nondimensional.") + name + ".uncertainty"), 0U) << name;
  }
}

// Of a shaft of four beams: the node of a peak is a number of a node.
TEST(ExactValues, ThePeaksNodeHasNoBar) {
  study::Deck deck = study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/tests/failure/base/rig.yaml",
                                 {"bearings.*.film={type: reynolds, cells: [24, 6]}",
                                  "studies=[{unbalance_response: {unbalance: [disc], nodes: [3], points: 40, "
                                  "range: {from: 500 rpm, to: 20000 rpm}}}]"});
  const auto v = test::values_of(test::run_deck(deck, "peak_node").at(0));
  EXPECT_EQ(v.at("peak.1.node"), 3);
  EXPECT_EQ(v.count("peak.1.node.uncertainty"), 0U);
  EXPECT_EQ(v.count("peak.1.speed.uncertainty"), 1U);
}

}  // namespace
