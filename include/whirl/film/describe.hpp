#pragma once
// Deck keys of the film room.

#include "whirl/deck/description.hpp"
#include "whirl/film/options.hpp"

namespace whirl::film {

[[nodiscard]] std::span<const deck::Name<Geometry::Bore>> names(Geometry::Bore);
[[nodiscard]] std::span<const deck::Name<Options::Kind>> names(Options::Kind);
[[nodiscard]] std::span<const deck::Name<Options::Cavitation>> names(Options::Cavitation);
[[nodiscard]] std::span<const deck::Name<Options::States>> names(Options::States);
[[nodiscard]] std::span<const deck::Name<Options::Turbulence>> names(Options::Turbulence);
[[nodiscard]] std::span<const deck::Name<Inlet::Type>> names(Inlet::Type);
[[nodiscard]] std::span<const deck::Name<Options::Quadrature>> names(Options::Quadrature);
[[nodiscard]] std::span<const deck::Name<Options::Differences>> names(Options::Differences);

void describe(deck::Description<Geometry>& d);
void describe(deck::Description<Liner>& d);
void describe(deck::Description<Groove>& d);
void describe(deck::Description<Contact>& d);
void describe(deck::Description<Inlet>& d);
void describe(deck::Description<Options>& d);
void describe(deck::Description<Lubricant>& d);

}  // namespace whirl::film
