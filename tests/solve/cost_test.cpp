// Which of two ways is thought to cost less turns where both were measured to cost the same (docs/speed.md, "Which way
// costs less"; bench_cost).

#include "whirl/solve/cycle/cost.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <utility>

using namespace whirl::solve;

namespace {

// The first size in steps of `step` at which the second way costs less; it stays so.
std::int64_t change(const std::function<bool(std::int64_t)>& second_is_cheaper, std::int64_t step) {
  std::int64_t at = step;
  while (!second_is_cheaper(at) && at < 10000) at += step;
  for (std::int64_t n = at; n < 10 * at; n += step) EXPECT_TRUE(second_is_cheaper(n)) << n;
  return at;
}

}  // namespace

// Compliant short films under a rigid rotor. Measured: dense 4.8 ms a point at 16 states against 5.7, at 24 8.9 against
// 7.0; on 60 intervals of degree 2 6.0 against 6.3 and 10.9 against 8.7.
TEST(CycleCost, SweepsBeginAtTwentyStatesOfFilms) {
  for (const auto& [degree, intervals] : {std::pair{4, 40}, {2, 60}}) {
    const auto at = change(
        [degree = degree, intervals = intervals](std::int64_t n) {
          const cost::CycleCounts c{
              .states = n + 4, .intervals = intervals, .degree = degree, .own = n, .band = 3, .forces = 2};
          return cost::sweeps(c) < cost::dense_joining(c);
        },
        1);
    EXPECT_GE(at + 4, 16);
    EXPECT_LE(at + 4, 28);
  }
}

// Five films of twelve states behind 104 of a train.
TEST(CycleCost, OfATrainInFilmsWithStatesSweepsAreCheaper) {
  const cost::CycleCounts c{.states = 164, .intervals = 60, .degree = 2, .own = 60, .band = 3, .forces = 10};
  EXPECT_LT(cost::sweeps(c), cost::dense_joining(c));
}

// Uniform shafts between two bearings, 13 entries a state. Measured: dense 11.7 ms at 72 states against 17.9, at 120
// 28.0 against 26.2, at 168 52.7 against 33.7.
TEST(CycleCost, TimeModesBeginAtAHundredStatesOfAShaft) {
  const auto modes = [](std::int64_t n, std::int64_t entries) {
    const cost::CycleCounts c{.states = n, .intervals = 60, .degree = 2, .forces = 4, .entries = entries};
    return cost::time_modes(c) < cost::dense_joining(c);
  };
  const auto at = change([&](std::int64_t n) { return modes(n, 13 * n); }, 8);
  EXPECT_GE(at, 88);
  EXPECT_LE(at, 144);
  // Reduced to 21 nodes its blocks are dense.
  EXPECT_FALSE(modes(104, 104 * 52));
}
