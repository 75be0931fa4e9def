#pragma once
// What studies of one film ask of their decks alike: the bearing, and the place of its journal or a load on it.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
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
[[nodiscard]] inline FilmAtRest::Pair load_of(const deck::OneOrMore& load) {
  return load.values.size() == 1 ? FilmAtRest::Pair{0, -load.values[0]}
                                 : FilmAtRest::Pair{load.values[0], load.values[1]};
}

/// Refuses a place beside a load, and loads of no or too many components.
template <class Options>
void check_place_or_load(const Options& o, const deck::Report& r) {
  if (o.load.values.empty()) return;
  for (const auto& [key, given] :
       {std::pair{"eccentricity", o.eccentricity.has_value()}, std::pair{"attitude", o.attitude.has_value()}})
    if (given) r.fail(key, fmt::format("the journal is where the film carries its 'load': leave '{}' out", key));
  if (o.load.values.size() > 2) return r.fail("load", "'load' must be one number, positive down, or [x, y]");
  if (std::ranges::all_of(o.load.values, [](double f) { return f == 0; })) r.fail("load", "'load' must not be zero");
}

/// Takes the journal where the options want it.
template <class Options>
void put_journal(FilmAtRest& film, const Options& o, double clearance) {
  if (!o.load.values.empty()) return film.carry(load_of(o.load));
  const double e = clearance * o.eccentricity.value_or(0), angle = o.attitude.value_or(0);
  film.hold({e * std::cos(angle), e * std::sin(angle)});
}

}  // namespace whirl::study
