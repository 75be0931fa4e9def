// Counts near and beyond what 32 bits hold.

#include "whirl/core/count.hpp"

#include <gtest/gtest.h>

#include "whirl/core/error.hpp"

using namespace whirl;

// 2e9 things on 1000 ranks: rank times things is a thousand times what an int holds.
TEST(Count, SharesOfLargeCountsAreNearEqual) {
  constexpr PetscInt count = 2'000'000'011;
  constexpr int size = 1000;
  EXPECT_EQ(core::begin_of_share(count, 0, size), 0);
  EXPECT_EQ(core::begin_of_share(count, size, size), count);
  for (int rank = 0; rank < size; ++rank) {
    const PetscInt share = core::begin_of_share(count, rank + 1, size) - core::begin_of_share(count, rank, size);
    EXPECT_GE(share, count / size) << rank;
    EXPECT_LE(share, count / size + 1) << rank;
  }
}

TEST(Count, RefusalsNameWhatAndTheLimit) {
  EXPECT_EQ(core::count_of(2'147'483'647, "states"), 2'147'483'647);
  try {
    (void)core::count_of(2'147'483'648, "states of a film");
    ADD_FAILURE() << "no error";
  } catch (const core::InputError& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("states of a film"), std::string::npos) << text;
    EXPECT_NE(text.find("2147483647"), std::string::npos) << text;
  }
}
