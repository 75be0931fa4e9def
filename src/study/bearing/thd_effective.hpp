#pragma once
// Films of one temperature beside a film with heat.

#include "study/bearing/thd_at_speed.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Puts the temperatures at which a film of one temperature, at the place of the journal that `film` has and with the
/// clearance that it has, has the same load (magnitude of the force), the same power loss and the same flow of the
/// supplies as `film`: `temperature.effective.*` K into `summary`, and of the film with the same load the relative
/// errors of the other quantities. The table `effective` in `group` has all: a row for each quantity that is held.
/// A quantity that no temperature up to one span of the film's temperatures beyond them gives is absent, with a
/// warning; one that is zero, as the power loss at rest, too. Collective. Cost: 10 to 30 flows of a film that is
/// solved.
void put_effective(io::Group& group, io::StudySummary& summary, ThdAtSpeed& film, double ambient);

/// Puts the temperature at which the heat balance of the whole film is even, at the place of the journal that `film`
/// has, and what a film of that temperature carries and loses. Walls that conduct have the mean temperature of their
/// surfaces. Puts nothing of a gas, whose Prandtl number is too small, and of a film that dissipates nothing.
/// Collective.
void put_lumped(io::StudySummary& summary, ThdAtSpeed& film, const ThdOptions& options, const film::Geometry& geometry);

}  // namespace whirl::study
