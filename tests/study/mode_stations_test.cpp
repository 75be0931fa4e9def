// Damped frequencies that pass the speed between two speeds, followed or not.

#include "study/linear/mode_stations.hpp"

#include <gtest/gtest.h>

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
