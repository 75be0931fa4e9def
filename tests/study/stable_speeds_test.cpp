// Stability over speeds from a few counts.
#include "study/linear/stable_speeds.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace whirl::study {
namespace {

std::vector<double> speeds(int n) {
  std::vector<double> out;
  for (int k = 0; k < n; ++k) out.push_back(100 + k);
  return out;
}

TEST(StableSpeeds, TheBorderIsFoundBetweenNeighboursByFewCounts) {
  std::size_t asked = 0;
  const StableSpeeds stable(speeds(1000), few_speeds(speeds(1000)), [&](const std::vector<double>& at) {
    asked += at.size();
    std::vector<int> out;
    for (const double s : at) out.push_back(s < 637 ? 0 : s < 900 ? 2 : 4);
    return out;
  });
  EXPECT_LE(asked, 13U + 2U * 7U);
  EXPECT_EQ(stable.at(636), 0);
  EXPECT_EQ(stable.at(637), 2);
  EXPECT_EQ(stable.at(899), 2);
  EXPECT_EQ(stable.at(900), 4);
  EXPECT_EQ(stable.at(636.5), StableSpeeds::unknown);
  const auto stretches = stable.stretches();
  ASSERT_EQ(stretches.size(), 2U);
  EXPECT_EQ(stretches[1].from, 637);
  EXPECT_EQ(stretches[1].to, 1099);
  io::StudySummary summary;
  put_verdict(summary, stable, "rad/s", "it leaves");
  EXPECT_EQ(summary.stability,
            fmt::format("unstable from 637 to 1099 rad/s (stable at 636), by the {} speeds counted", asked));
  ASSERT_EQ(summary.warnings.size(), 1U);
  EXPECT_EQ(summary.warnings[0], "the equilibrium is unstable from 637 to 1099 rad/s (stable at 636): it leaves");
}

TEST(StableSpeeds, WhatIsNotKnownIsUndetermined) {
  const auto all = [](int number) {
    return StableSpeeds(speeds(5), few_speeds(speeds(5)),
                        [number](const auto& at) { return std::vector<int>(at.size(), number); });
  };
  io::StudySummary stable, unknown, unstable;
  put_verdict(stable, all(0), "rad/s", "it leaves");
  put_verdict(unknown, all(StableSpeeds::unknown), "rad/s", "it leaves");
  put_verdict(unstable, all(2), "rad/s", "it leaves");
  EXPECT_EQ(stable.stability, "stable at the 5 speeds counted");
  EXPECT_TRUE(stable.warnings.empty());
  EXPECT_EQ(unknown.stability, "undetermined at the 5 speeds counted");
  EXPECT_EQ(unknown.warnings.size(), 1U);
  EXPECT_EQ(unstable.stability, "unstable at the 5 speeds counted");
  EXPECT_EQ(unstable.warnings.size(), 1U);
}

// A stretch between two counted speeds is seen from a speed inside it that is always counted, up to its borders.
TEST(StableSpeeds, WhatMattersIsAlwaysCounted) {
  const auto window = [](const std::vector<double>& at) {
    std::vector<int> out;
    for (const double s : at) out.push_back(s > 500 && s < 514 ? 2 : 0);
    return out;
  };
  const auto with = [&](double speed) {
    std::vector<double> first = few_speeds(speeds(1000));
    first.push_back(speed);
    return StableSpeeds(speeds(1000), first, window);
  };
  const StableSpeeds seen = with(507), unseen = with(900);
  EXPECT_EQ(seen.at(501), 2);
  EXPECT_EQ(seen.at(513), 2);
  EXPECT_EQ(seen.at(500), 0);
  EXPECT_EQ(seen.at(514), 0);
  EXPECT_EQ(unseen.counted(), 14U);
  io::StudySummary summary;
  put_verdict(summary, unseen, "rad/s", "it leaves");
  EXPECT_EQ(summary.stability, "stable at the 14 speeds counted");
}

}  // namespace
}  // namespace whirl::study
