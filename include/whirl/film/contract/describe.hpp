#pragma once
// Deck keys of the film room. Those of a kind stand with the kind.

#include "whirl/deck/description.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/thermal/describe.hpp"  // names of Turbulence

namespace whirl::film {

[[nodiscard]] std::span<const deck::Name<Geometry::Bore>> names(Geometry::Bore);
[[nodiscard]] std::span<const deck::Name<Inlet::Type>> names(Inlet::Type);
[[nodiscard]] std::span<const deck::Name<Linear::Beyond>> names(Linear::Beyond);
[[nodiscard]] std::span<const deck::Name<States>> names(States);

void describe(deck::Description<Geometry>& d);
void describe(deck::Description<Groove>& d);
void describe(deck::Description<Hole>& d);
void describe(deck::Description<Inlet>& d);
void describe(deck::Description<Options>& d);
void describe(deck::Description<Lubricant>& d);

}  // namespace whirl::film
