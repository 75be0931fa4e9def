// Who shares the states of a machine, by counts.

#include "study/layout.hpp"

#include <gtest/gtest.h>

#include "whirl/film/options.hpp"
#include "whirl/solve/cycle/spread_collocation.hpp"
#include "whirl/study/layout_options.hpp"

namespace whirl::study {
namespace {

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

// An elimination tells so many films apart; cycles of more are solved on whole machines.
TEST(LayoutTest, CyclesAreSpreadWhereEliminationServes) {
  LayoutOptions options;
  options.machine = LayoutOptions::Machine::all_ranks;
  constexpr std::size_t most = solve::SpreadCollocation::most_parts;
  EXPECT_FALSE(spreads_cycles(options, machine_of(0), 24, 2));
  EXPECT_TRUE(spreads_cycles(options, machine_of(1), 24, 2));
  EXPECT_TRUE(spreads_cycles(options, machine_of(most), 24, 2));
  EXPECT_FALSE(spreads_cycles(options, machine_of(most + 1), 24, 2));
  // Films without states are no parts.
  system::Machine more = machine_of(most);
  more.bearings.resize(most + 5);
  EXPECT_TRUE(spreads_cycles(options, more, 24, 2));
}

}  // namespace
}  // namespace whirl::study
