#pragma once
// How near a journal may come to its bearing.

#include <array>

#include "whirl/film/contract/bore.hpp"

namespace whirl::film {

/// Film thickness [m] below which journal and bore count as touching if nobody says more: three times a composite
/// roughness of clearance/6000, a lambda ratio of 3. At a clearance of 180 um that is a roughness of 30 nm, which only
/// superfinished surfaces have: no real bearing keeps its surfaces apart with less.
/// Source: Hamrock, Schmid and Jacobson (2004), sec. 3.8, for the lambda ratio.
[[nodiscard]] double default_minimum_film(const Geometry& geometry);

/// Least film thickness [m] over all pads of a rigid bore, exactly and free of any mesh, with the journal at `position`
/// as in JournalMotion (set the slopes to zero for a film that ignores tilt). Zero or negative: journal and pad touch.
[[nodiscard]] double minimum_thickness(const Geometry& geometry, const std::array<double, 4>& position);

}  // namespace whirl::film
