// Who holds the films of a cycle: whole machines as long as their intervals fit into memory.

#include <gtest/gtest.h>

#include "study/cost.hpp"
#include "study/layout.hpp"
#include "whirl/study/deck.hpp"
#include "whirl/study/layout_options.hpp"

using namespace whirl;

namespace {

constexpr double intervals = 32, points = 2;

study::Deck train(const std::string& deck, const std::vector<std::string>& overrides) {
  return study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/turbine_train/" + deck, overrides);
}

// With the shaft of the liners' deck, which is reduced.
study::Deck contents(const std::string& cells) {
  study::Deck out = train("liners.yaml", {});
  out.machine.bearings =
      train("mass_conserving.yaml", {"bearings.*.film.states=dynamic", "bearings.*.film.cells=" + cells})
          .machine.bearings;
  return out;
}

bool spread(const study::Deck& d) {
  return study::spreads_cycles(d.layout, d.machine, intervals, points);
}

}  // namespace

// Films are bands: twice the cells in both directions are eight times the numbers. 1.3 GB were measured on 120 x 24.
TEST(CycleLayout, MemoryOfFilmsGrowsWithTheirBand) {
  const auto memory = [](const char* cells) {
    return study::memory_of_cycles(contents(cells).machine, intervals, points, true);
  };
  const double once = memory("[120, 24]"), twice = memory("[240, 48]");
  EXPECT_GT(once, 0.65e9);
  EXPECT_LT(once, 2.6e9);
  EXPECT_GT(twice, 5 * once);
  EXPECT_LT(twice, 9 * once);
}

TEST(CycleLayout, FilmsThatFillAndEmptyAreSpreadWhereTheyMust) {
  using enum study::LayoutOptions::Machine;
  study::Deck d = contents("[120, 24]");
  EXPECT_FALSE(spread(d));
  d.layout.cycle_memory = 1e8;
  EXPECT_TRUE(spread(d));
  d.layout.machine = one_rank;
  EXPECT_FALSE(spread(d));
  d.layout = {};
  d.layout.machine = all_ranks;
  EXPECT_TRUE(spread(d));
  EXPECT_TRUE(spread(contents("[240, 48]")));
  EXPECT_FALSE(spread(contents("[16, 4]")));
  EXPECT_TRUE(spread(train("liners.yaml", {})));
}
