#pragma once
// What studies of one film ask of their decks: the bearing, and a load on its journal.

#include <array>
#include <optional>
#include <string>

#include "study/bearing/film_at_rest.hpp"
#include "whirl/deck/one_or_more.hpp"
#include "whirl/study/study.hpp"
#include "whirl/system/options.hpp"

namespace whirl::study {

/// The bearing of that name, the first of the deck if it is empty. Reports a name that is none, a bearing without film,
/// and a film of gas whose pressure stands still; then nothing is returned.
[[nodiscard]] std::optional<std::size_t> film_to_look_at(const system::Machine& machine, const std::string& name,
                                                         const deck::Report& report);

/// [N] along x and y: one number acts downwards.
[[nodiscard]] inline FilmAtRest::Pair load_along(const deck::OneOrMore& load) {
  return load.values.size() == 1 ? FilmAtRest::Pair{0, -load.values[0]}
                                 : FilmAtRest::Pair{load.values[0], load.values[1]};
}

}  // namespace whirl::study
