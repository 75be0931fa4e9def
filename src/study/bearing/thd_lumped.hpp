#pragma once
// What a film of one temperature would say of a film with heat.

#include "study/bearing/thd_at_speed.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Puts the temperature at which the heat balance of the whole film is even, at the place of the journal that `film`
/// has, and what a film of that temperature carries and loses. Walls that conduct have the mean temperature of their
/// surfaces. Puts nothing of a gas, whose Prandtl number is too small, and of a film that dissipates nothing.
/// Collective.
void put_lumped(io::StudySummary& summary, ThdAtSpeed& film, const ThdOptions& options, const film::Geometry& geometry);

}  // namespace whirl::study
