#include "whirl/film/contract/film.hpp"

#include "whirl/core/error.hpp"
#include "whirl/core/sparse_lu.hpp"

namespace whirl::film {

std::span<const Port> Film::ports() const {
  return std::span(all_ports).first(2);
}

Film::Film() = default;
Film::~Film() = default;

const Share& Film::whole() const {
  if (!whole_) whole_ = std::make_unique<const Share>(share(0, static_cast<int>(states())));
  return *whole_;
}

void Film::evaluate(const JournalMotion& motion, std::span<const double> states, std::span<const double> rates,
                    Need need, StateResponse& response) {
  core::require(states.size() == this->states() && rates.size() == states.size(), "states of a film");
  const Share& all = whole();
  if (all.seen.size() == states.size()) return evaluate(motion, all, states, rates, need, response);
  evaluate(motion, all, seen_of(all, states), seen_of(all, rates), need, response);
}

void Film::evaluate(const JournalMotion& motion, Need need, Response& response) {
  core::require(states() == 0, "a film without states");
  StateResponse all;
  evaluate(motion, whole(), {}, {}, need, all);
  response = all.journal;
}

}  // namespace whirl::film
