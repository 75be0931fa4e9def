#pragma once
// What the studies of a run found about the machine at its service speed.

#include <span>

#include "whirl/deck/units.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Stability with its margins in speed and log decrement, critical speeds on either side, least film, highest pressure
/// and temperature, largest vibration, each with the study that it is taken from; what no study gives is a fact that
/// says which study would. `results` holds a group for each of the studies, under io::safe_name of its name. `films`:
/// whether a bearing has a film.
[[nodiscard]] io::Service service_of(const deck::Quantity& speed, std::span<const io::StudySummary> studies,
                                     const io::Group& results, bool films = true);

}  // namespace whirl::study
