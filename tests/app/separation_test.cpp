// Separation margins of API 617: 17 (1 - 1/(AF - 1.5)) percent below the operating range, ten percent more above it.

#include "study/linear/separation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

using whirl::study::separation;

TEST(Separation, IsCountedFromTheNearerBorder) {
  const auto below = separation(2700, 8, 3000, 3600), above = separation(4500, 8, 3000, 3600);
  EXPECT_DOUBLE_EQ(below.actual, 0.1);
  EXPECT_NEAR(below.required, 0.143846, 1e-6);
  EXPECT_DOUBLE_EQ(above.actual, 0.25);
  EXPECT_NEAR(above.required, 0.243846, 1e-6);
}

TEST(Separation, IsZeroInsideTheRange) {
  EXPECT_EQ(separation(3100, 8, 3000, 3600).actual, 0);
  EXPECT_NEAR(separation(3100, 8, 3000, 3600).required, 0.143846, 1e-6);
  EXPECT_NEAR(separation(3500, 8, 3000, 3600).required, 0.243846, 1e-6);
  EXPECT_EQ(separation(3000, 8, 3000, 3000).actual, 0);
}

// By its mode, of which unbalance knows nothing; a critical speed that is far enough needs no word of that.
TEST(Separation, IsNotAskedOfWhirlThatUnbalanceDoesNotExcite) {
  using namespace whirl;
  io::StudySummary summary;
  const auto put = [&](const char* number, double speed, double mode, bool excited) {
    const std::string head = std::string("critical.") + number + ".";
    summary.set(head + "speed", speed, "rpm");
    summary.set(head + "mode", mode, "1");
    if (!excited) summary.set(head + "excited", 0, "1");
    study::put_margins(summary, head, speed, 0.01, 0.012, 1e-9, deck::Range{1480, 1480, "rpm"});
  };
  put("1", 1587, 1, false);
  put("2", 1590, 2, true);
  put("3", 3600, 3, false);
  for (const int mode : {1, 2, 3}) {
    summary.modes.push_back({1480, 0, 0, 0, mode == 2 ? "mixed" : "backward", "rpm"});
    summary.modes.back().more["mode"] = mode;
  }
  const auto all = study::critical_speeds_of(summary);
  ASSERT_EQ(all.size(), 3);
  EXPECT_EQ(all[0].verdict, study::not_excited);
  EXPECT_EQ(all[1].verdict, "too near");
  EXPECT_EQ(all[2].verdict, "far enough");
}

TEST(Separation, IsNotAskedOfDampedPeaks) {
  EXPECT_EQ(separation(2900, 2.49, 3000, 3600).required, 0);
  EXPECT_NEAR(separation(2900, 2.5, 3000, 3600).required, 0, 1e-15);
  EXPECT_NEAR(separation(3900, 2.5, 3000, 3600).required, 0.1, 1e-15);
  EXPECT_TRUE(std::isnan(separation(2900, std::numeric_limits<double>::quiet_NaN(), 3000, 3600).required));
}

TEST(Separation, VerdictsLeaveOpenWhatABarContains) {
  using whirl::io::Quantity;
  using whirl::study::margin_verdict;
  const Quantity af{8, "1", {{"uncertainty", 0.1}}}, required{0.14, "1"};
  EXPECT_EQ(margin_verdict(af, {0.20, "1"}, required), "far enough");
  EXPECT_EQ(margin_verdict(af, {0.10, "1"}, required), "too near");
  EXPECT_EQ(margin_verdict(af, {0.10, "1", {{"uncertainty", 0.05}}}, required), "undetermined");
  EXPECT_EQ(margin_verdict({2.3, "1", {{"uncertainty", 0.1}}}, {0, "1"}, {0, "1"}), "damped, not critical");
  EXPECT_EQ(margin_verdict({2.45, "1", {{"uncertainty", 0.1}}}, {0, "1"}, {0, "1"}), "undetermined");
  EXPECT_EQ(margin_verdict(af, {}, {}), "");
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(whirl::study::separation(2900, infinite, 3000, 3600).required, 0.17);
  EXPECT_EQ(margin_verdict({infinite, "1"}, {0.01, "1"}, {0.17, "1"}), "too near");
  EXPECT_EQ(margin_verdict({}, {0.1, "1"}, required), "");
}
