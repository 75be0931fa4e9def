// Which of two ways is thought to cost less turns where both were measured to cost the same (docs/speed.md, "Which way
// costs less"; bench_cost).

#include "whirl/core/cost.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>

using namespace whirl::core;

namespace {

// The first size in steps of `step` at which the second way costs less; it stays so.
std::int64_t change(const std::function<bool(std::int64_t)>& second_is_cheaper, std::int64_t step) {
  std::int64_t at = step;
  while (!second_is_cheaper(at) && at < 10000) at += step;
  for (std::int64_t n = at; n < 10 * at; n += step) EXPECT_TRUE(second_is_cheaper(n)) << n;
  return at;
}

}  // namespace

// Uniform shafts between two bearings, 13 entries a state. Measured: dense 0.155 ms a step at 168 states against 0.183,
// at 216 0.273 against 0.205.
TEST(Cost, StepsInTimeAreSparseFromTwoHundredStates) {
  const auto at = change([](std::int64_t n) { return !cost::dense_is_cheaper(cost::Work::step, n, 13 * n); }, 1);
  EXPECT_GE(at, 168);
  EXPECT_LE(at, 216);
  EXPECT_TRUE(cost::dense_is_cheaper(cost::Work::step, 300, 300 * 150)) << "of blocks that are dense";
}

// A V-cycle of 400 x 80 cells on two ranks exchanges on levels of 400, 200 and 100 lines.
TEST(Cost, LevelsAreRepeatedBelowFiftyLinesARank) {
  const auto repeated = [](int lines, int line, int ranks) {
    return cost::repeated_level(lines, line, ranks) < cost::exchanged_level();
  };
  EXPECT_FALSE(repeated(100, 80, 2));
  EXPECT_TRUE(repeated(50, 80, 2));
  EXPECT_TRUE(repeated(100, 40, 2)) << "shorter lines are less work";
}
