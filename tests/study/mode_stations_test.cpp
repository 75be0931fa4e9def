// Damped frequencies that pass the speed between two speeds, followed or not.

#include "study/linear/mode_stations.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace whirl::study;
using Lambda = std::complex<double>;

// Modes by identity (0: not followed) and eigenvalue.
Station at(double speed, const std::vector<std::pair<int, Lambda>>& modes) {
  Station s;
  s.speed = speed;
  for (const auto& [id, lambda] : modes) {
    s.modes.emplace_back();
    s.modes.back().id = id;
    s.modes.back().lambda = lambda;
  }
  return s;
}

}  // namespace

TEST(ModeStations, ACrossingThatIsFollowedIsNotLost) {
  EXPECT_TRUE(
      lost_crossings({at(0, {{1, {-1, 100}}, {2, {-1, 300}}}), at(200, {{1, {-1, 90}}, {2, {-1, 310}}})}).empty());
}

TEST(ModeStations, WhereATrackBreaksItsCrossingIsLost) {
  const auto found = lost_crossings({at(0, {{1, {-1, 100}}, {2, {-1, 300}}}), at(200, {{3, {-1, 90}}, {2, {-1, 310}}}),
                                     at(250, {{3, {-1, 90}}, {2, {-1, 310}}})});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].from, 0);
  EXPECT_EQ(found[0].to, 200);
  EXPECT_EQ(found[0].count, 1);
}

TEST(ModeStations, WhatComesFromOverdampedMotionHasCrossedNothing) {
  EXPECT_TRUE(lost_crossings({at(0, {{1, {-1, 300}}}), at(200, {{1, {-1, 310}}, {2, {-10, 90}}})}).empty());
}

TEST(ModeStations, WhatHardlyVibratesIsNoCriticalSpeed) {
  EXPECT_TRUE(lost_crossings({at(0, {{1, {-500, 100}}}), at(200, {{2, {-500, 90}}})}).empty());
}

namespace {

// Modes of one node with the shape of circles forward, backward: a machine of two whose frequencies are functions of
// the speed, and `turn` of the shape over it.
ShaftMode circle(double frequency, double real, double part) {
  ShaftMode m;
  m.lambda = {real, frequency};
  m.x = {std::cos(part), std::sin(part)};
  m.y = {0, 0};
  return m;
}

Station of(double speed, std::vector<ShaftMode> modes, bool reported) {
  Station s{speed, reported, std::move(modes)};
  s.listed = s.modes.size();
  return s;
}

std::vector<Station> followed(const std::function<std::vector<ShaftMode>(double)>& machine,
                              std::vector<double> speeds) {
  std::vector<Station> stations;
  for (const double s : speeds) stations.push_back(of(s, machine(s), true));
  follow(stations, 1, [&](const std::vector<double>& asked) {
    std::vector<Station> more;
    for (const double s : asked) more.push_back(of(s, machine(s), false));
    return more;
  });
  return stations;
}

std::vector<double> critical(const std::vector<Station>& stations,
                             const std::function<std::vector<ShaftMode>(double)>& machine) {
  std::vector<double> out;
  for (const Crossing& c : crossings_of(stations))
    if (c.border == Border::critical) out.push_back(locate(c, machine).speed);
  return out;
}

}  // namespace

// The frequency falls from 400 to 100 and the shape turns through 150 degrees: at both ends of a wide range the mode
// looks like another one.
TEST(ModeStations, AModeThatChangesIsFollowedToItsCriticalSpeed) {
  const auto machine = [](double s) { return std::vector{circle(400 / (1 + 3 * s / 1000), -1, 2.6 * s / 1000)}; };
  const auto stations = followed(machine, {10, 1000});
  EXPECT_TRUE(lost_crossings(stations).empty());
  const auto found = critical(stations, machine);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0], 234.720, 1e-3);  // s (1 + 3 s/1000) = 400
}

// A frequency that runs beside the speed and dips below it between two speeds; and growth between two speeds.
TEST(ModeStations, ADipBetweenSpeedsIsSeen) {
  const auto dips = [](double s) { return std::vector{circle(s - 10 + 1e-3 * (s - 330) * (s - 330), -1, 0.3)}; };
  const auto found = critical(followed(dips, {100, 200, 300, 450, 600}), dips);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0], 230, 1e-3);
  EXPECT_NEAR(found[1], 430, 1e-3);
  const auto grows = [](double s) { return std::vector{circle(1e4, 1 - 1e-4 * (s - 330) * (s - 330), 0.3)}; };
  const auto crossings = crossings_of(followed(grows, {0, 210, 450, 600}));
  ASSERT_EQ(crossings.size(), 2U);
  EXPECT_NEAR(locate(crossings[0], grows).speed, 230, 1e-3);
  EXPECT_NEAR(locate(crossings[1], grows).speed, 430, 1e-3);
}

// Where neither mode is known again the place is that of the bracket, and says so; where a real part jumps, the jump.
TEST(ModeStations, ABorderThatCannotBeFollowedHasABar) {
  Crossing c{Border::critical, 100, 300, 50, -50, circle(250, -1, 0.3), 1, false, circle(150, -1, 0.3)};
  const CrossingPoint none = locate(c, [](double) { return std::vector{circle(1e5, -1, 1.5)}; });
  EXPECT_EQ(none.speed, 200);
  EXPECT_EQ(none.left, 100);
  EXPECT_FALSE(none.followed);
  c = {Border::stability, 100, 300, -1, 2, circle(250, 2, 0.3), 1, false, circle(250, -1, 0.3)};
  const CrossingPoint jump = locate(c, [](double s) { return std::vector{circle(250, s < 217 ? -1 : 2, 0.3)}; });
  EXPECT_NEAR(jump.speed, 217, 0.003);
  EXPECT_TRUE(jump.followed);
  EXPECT_LT(jump.left, 1e-5 * jump.speed);
}

// Frequencies that scatter by 1e-5, as those about equilibria of a tolerance do.
TEST(ModeStations, ACriticalSpeedIsFoundAsWellAsFrequenciesAreKnown) {
  const auto noisy = [](double s) { return std::vector{circle(400 - 0.3 * s + 3e-3 * std::sin(1e7 * s), -1, 0.3)}; };
  Crossing c{Border::critical, 100, 500, 270, -250, noisy(500)[0], 1, false, noisy(100)[0]};
  const CrossingPoint found = locate(c, noisy);
  EXPECT_TRUE(found.followed);
  EXPECT_LT(found.left, 6e-3 / 1.3);  // the noise of two looks
  EXPECT_NEAR(found.speed, 400 / 1.3, found.left);
}

TEST(ModeStations, OneCriticalSpeedFoundTwiceIsOne) {
  std::vector<Station> stations{of(100, {circle(150, -1, 0), circle(160, -1, 1.5)}, true),
                                of(200, {circle(150, -1, 0), circle(160, -1, 1.5)}, true)};
  for (Station& s : stations)
    for (int k = 0; k < 2; ++k) s.modes[static_cast<std::size_t>(k)].id = k + 1;
  const auto crossings = crossings_of(stations);
  ASSERT_EQ(crossings.size(), 2U);
  const CrossingPoint one{150, {-1, 150}, circle(150, -1, 0).both()},
      other{160, {-1, 160}, circle(160, -1, 1.5).both()}, equal{150, {-1, 150}, circle(150, -1, 1.5).both()};
  std::vector<LostCrossings> lost;
  EXPECT_EQ(found_twice(stations, crossings, {one, other}, lost), (std::vector{false, false}));
  EXPECT_EQ(found_twice(stations, crossings, {one, equal}, lost), (std::vector{false, false}));
  EXPECT_TRUE(lost.empty());
  // Two modes came below the speed, and one place is known.
  EXPECT_EQ(found_twice(stations, crossings, {one, one}, lost), (std::vector{false, true}));
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_EQ(lost[0].count, 1);
}
