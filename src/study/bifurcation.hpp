#pragma once
// Bifurcations as results show them.

#include <string>
#include <vector>

#include "study/parameter.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/solve/branch/continuation.hpp"
#include "whirl/system/options.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

[[nodiscard]] Event event_of(solve::Event event);
[[nodiscard]] io::BifurcationType type_of(solve::Event event);
/// Whether results shall hold such an event: those asked for, and branch points in any case.
[[nodiscard]] bool wanted(solve::Event event, const std::vector<Event>& detect);

/// Whether a pair of multipliers is none that anybody may rely on: beside a fold two near +1 may seem to cross as a
/// pair, by rounding, at a place that no other mesh confirms (its bar is not a number).
[[nodiscard]] bool doubtful_pair(const solve::LocatedEvent& found, double uncertainty);

/// What a bifurcation at `value` (in `unit`) of the option at `path` has by its place alone: that, and the
/// nondimensional groups of the machine there. `system` is the one that is followed.
[[nodiscard]] io::Bifurcation bifurcation_at(io::BifurcationType type, double value, const std::string& path,
                                             const std::string& unit, const system::Machine& machine,
                                             const std::vector<std::string>& unbalance, const system::Plant& system);

/// A further number of a bifurcation; not a number if it has none of that name.
[[nodiscard]] double more_of(const io::Bifurcation& b, const std::string& name);

/// A table of bifurcations: type, parameter, uncertainty, angle.
void put_bifurcations(io::Group& group, const std::vector<io::Bifurcation>& all);

}  // namespace whirl::study
