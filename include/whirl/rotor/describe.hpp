#pragma once
// Deck keys of the rotor room.

#include "whirl/deck/description.hpp"
#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

[[nodiscard]] std::span<const deck::Name<Options::Type>> names(Options::Type);
[[nodiscard]] std::span<const deck::Name<Shear>> names(Shear);
[[nodiscard]] std::span<const deck::Name<BeamElement>> names(BeamElement);
[[nodiscard]] std::span<const deck::Name<LossFrame>> names(LossFrame);
[[nodiscard]] std::span<const deck::Name<Reduction::Type>> names(Reduction::Type);

void describe(deck::Description<Segment>& d);
void describe(deck::Description<Disc>& d);
void describe(deck::Description<Coupling>& d);
void describe(deck::Description<Material>& d);
void describe(deck::Description<Reduction>& d);
void describe(deck::Description<Options>& d);

}  // namespace whirl::rotor
