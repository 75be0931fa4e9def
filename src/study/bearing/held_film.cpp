#include "study/bearing/held_film.hpp"

#include <fmt/core.h>

#include "whirl/film/contract/options.hpp"

namespace whirl::study {

std::optional<std::size_t> bearing_to_look_at(const system::Machine& machine, const std::string& name,
                                              const deck::Report& report) {
  const auto found = name.empty() ? std::optional<std::size_t>(0) : system::find_bearing(machine, name);
  if (!found)
    report.fail("bearing", fmt::format("there is no bearing '{}'{}", name,
                                       deck::did_you_mean_one_of(name, system::bearing_names(machine))));
  return machine.bearings.empty() ? std::nullopt : found;
}

std::optional<std::size_t> film_to_look_at(const system::Machine& machine, const std::string& name,
                                           const deck::Report& report) {
  const auto found = bearing_to_look_at(machine, name, report);
  if (!found || !film::facts(machine.bearings[*found].film).coefficients) return found;
  report.fail(name.empty() ? "" : "bearing", "a linear film has the coefficients that the deck gives it");
  return std::nullopt;
}

}  // namespace whirl::study
