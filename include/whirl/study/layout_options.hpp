#pragma once
// What a deck may say about how ranks share the work, and how much of it there may be.

#include <optional>
#include <span>

#include "whirl/deck/description.hpp"

namespace whirl::study {

/// What error bars come from: other meshes of films, time and shaft, or nothing at all.
enum class BarsFrom { meshes, none };
[[nodiscard]] std::span<const deck::Name<BarsFrom>> names(BarsFrom);

/// Who holds one machine, its states and matrices, and how large others are made beside it.
struct LayoutOptions {
  enum class Machine { automatic, one_rank, all_ranks };
  BarsFrom bars = BarsFrom::meshes;  ///< a key of the deck itself, see layout_of()
  Machine machine = Machine::automatic;
  int shaft_freedoms = 20000;      ///< of the shaft before its reduction; other systems: half their states
  int film_states = 3000;          ///< of all films together
  std::optional<int> time_groups;  ///< of ranks that share the intervals of a cycle whose states are spread
  double cycle_memory = 4e9;       ///< of a cycle's intervals, up to which films that fill and empty are whole [byte]
  int refined_states = 4000;       ///< of all films together, up to which bars are computed on finer meshes too
};
[[nodiscard]] std::span<const deck::Name<LayoutOptions::Machine>> names(LayoutOptions::Machine);
void describe(deck::Description<LayoutOptions>& d);

}  // namespace whirl::study
