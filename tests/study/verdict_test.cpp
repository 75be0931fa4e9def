// Which bifurcation is the threshold of stability.

#include "study/bars/verdict.hpp"

#include <gtest/gtest.h>

using whirl::study::BorderEvent;
using whirl::study::threshold_among;

// Stable below 4500, unstable to 5000, stable to 5600, unstable beyond.
TEST(Threshold, IsTheFirstLossWithRisingParameterInEitherDirection) {
  const std::vector<BorderEvent> rising{{true, true}, {true, false}, {true, true}},
      falling{{true, false}, {true, true}, {true, false}};
  EXPECT_EQ(threshold_among(rising, true), 0);
  EXPECT_EQ(threshold_among(falling, false), 2);
}

TEST(Threshold, IsNoneWhereOthersAreUnstable) {
  EXPECT_EQ(threshold_among({{false, true}, {false, true}}, true), -1);
  EXPECT_EQ(threshold_among({}, false), -1);
  // Stability that is only regained on the way up is no threshold.
  EXPECT_EQ(threshold_among({{true, false}}, true), -1);
}
