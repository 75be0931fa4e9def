#pragma once
// What a deck may say about how ranks share the work.

#include <span>

#include "whirl/deck/description.hpp"

namespace whirl::study {

/// Who holds one machine, its states and matrices.
struct LayoutOptions {
  enum class Machine { automatic, one_rank, all_ranks };
  Machine machine = Machine::automatic;
  int shaft_freedoms = 20000;  ///< of the shaft before its reduction; other systems: half their states
  int film_states = 3000;      ///< of all films together
};
[[nodiscard]] std::span<const deck::Name<LayoutOptions::Machine>> names(LayoutOptions::Machine);
void describe(deck::Description<LayoutOptions>& d);

}  // namespace whirl::study
