#pragma once
// What studies of one film ask of their decks: the bearing, and a load on its journal.

#include <fmt/format.h>

#include <algorithm>
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

/// The bearing that is named, the first without a name. Reports a name that is none; nothing then, and of no bearings.
[[nodiscard]] std::optional<std::size_t> bearing_to_look_at(const system::Machine& machine, const std::string& name,
                                                            const deck::Report& report);

/// Options `eccentricity`, `attitude` and `load` of a journal at a place or under a load.
template <class O>
void describe_place(deck::Description<O>& d) {
  d.add("eccentricity", &O::eccentricity, deck::Check{.min = 0, .max = 1, .max_open = true},
        "distance of the journal from the bearing centre, in clearances");
  d.add("attitude", &O::attitude, "rad", deck::any, "direction of the journal from there, from +x counter-clockwise");
  d.add("load", &O::load, "N", deck::any,
        "on the journal, instead of its place: one number, positive down, or [x, y]; the journal is where the force of "
        "the film balances it");
}
/// Reports a place beside a load, and a load that is none.
template <class O>
void check_place(const O& o, const deck::Report& r) {
  if (o.load.values.empty()) return;
  for (const auto& [key, given] :
       {std::pair{"eccentricity", o.eccentricity.has_value()}, std::pair{"attitude", o.attitude.has_value()}})
    if (given) r.fail(key, fmt::format("the journal is where the film carries its 'load': leave '{}' out", key));
  if (o.load.values.size() > 2) return r.fail("load", "'load' must be one number, positive down, or [x, y]");
  if (std::ranges::all_of(o.load.values, [](double f) { return f == 0; })) r.fail("load", "'load' must not be zero");
}

/// [N] along x and y: one number acts downwards.
[[nodiscard]] inline FilmAtRest::Pair load_along(const deck::OneOrMore& load) {
  return load.values.size() == 1 ? FilmAtRest::Pair{0, -load.values[0]}
                                 : FilmAtRest::Pair{load.values[0], load.values[1]};
}

}  // namespace whirl::study
