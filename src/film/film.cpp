#include "whirl/film/film.hpp"

#include "film/steady.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/coefficients.hpp"

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

long relax(Film& film, const JournalMotion& motion, std::vector<double>& states) {
  if (film.states() == 0) return 0;
  const std::vector<double> rest(states.size(), 0.0);
  Steady steady(film);
  steady.solve(motion, rest, Steady::Until::small_step, Need::force, states);
  return steady.factorisations();
}

PortCoefficients port_coefficients(Film& film, const JournalMotion& motion, std::span<const double> states,
                                   double omega) {
  return FrequencyCoefficients(film, motion, states).at(omega);
}

Coefficients coefficients(Film& film, const JournalMotion& motion, std::span<const double> states, double omega) {
  const PortCoefficients all = port_coefficients(film, motion, states, omega);
  Coefficients out;
  for (std::size_t i = 0; i < 4; ++i) {
    out.stiffness[i] = all.stiffness[i / 2][i % 2];
    out.damping[i] = all.damping[i / 2][i % 2];
  }
  return out;
}

}  // namespace whirl::film
