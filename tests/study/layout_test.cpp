// Who holds the films of a cycle: counts of memory, and of the parts that elimination tells apart, decide.

#include <gtest/gtest.h>

#include "source_dir.hpp"
#include "study/cost.hpp"
#include "study/layout.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/solve/cycle/spread_collocation.hpp"
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

// So many films with states.
system::Machine machine_of(std::size_t films) {
  film::Reynolds film;
  film.cavitation = film::Reynolds::Cavitation::mass_conserving;
  film.states = film::Reynolds::States::dynamic;
  film.cells = {8, 2};
  system::Machine machine;
  machine.system.name = "rotor";
  machine.bearings.resize(films);
  for (system::Bearing& bearing : machine.bearings) bearing.film = film;
  return machine;
}

}  // namespace

// Films are bands: twice the cells in both directions are eight times the numbers. 1.3 GB were measured on 120 x 24.
TEST(CycleLayout, MemoryOfFilmsGrowsWithTheirBand) {
  const auto memory = [](const char* cells) {
    return study::memory_of_cycles(contents(cells).machine, intervals, points, true);
  };
  const double once = memory("[120, 24]"), twice = memory("[240, 48]");
  EXPECT_GT(once, 0.9e9);
  EXPECT_LT(once, 1.8e9);
  EXPECT_GT(twice, 5 * once);
  EXPECT_LT(twice, 9 * once);
}

// 4.4 GB were measured on a branch with eigenvalues, 5.0 GB with ten modes of 800,000 states (docs/mass_conserving.md).
TEST(Memory, EquilibriaOfLargeFilmsTakeWhatWasMeasured) {
  const system::Machine large = contents("[120, 24]").machine;
  const double states = study::n_film_states(large), bytes = study::memory_of_equilibria(large);
  EXPECT_GT(bytes, 4.4e9 / 800e3 * states);
  EXPECT_LT(bytes, 2 * 4.4e9 / 800e3 * states);
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

// Films with states are parts; one is enough, and any number is solved.
TEST(CycleLayout, CyclesAreSpreadWhereFilmsHaveStates) {
  study::LayoutOptions options;
  options.machine = study::LayoutOptions::Machine::all_ranks;
  EXPECT_FALSE(study::spreads_cycles(options, machine_of(0), intervals, points));
  EXPECT_TRUE(study::spreads_cycles(options, machine_of(1), intervals, points));
  EXPECT_TRUE(study::spreads_cycles(options, machine_of(70), intervals, points));
  // Films without states are no parts.
  system::Machine more = machine_of(1);
  more.bearings.resize(6);
  EXPECT_TRUE(study::spreads_cycles(options, more, intervals, points));
}
