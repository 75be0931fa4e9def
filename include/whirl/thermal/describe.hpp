#pragma once
// Descriptions of the options of a film with heat.

#include "whirl/thermal/options.hpp"
#include "whirl/thermal/turbulence.hpp"

namespace whirl::thermal {

[[nodiscard]] std::span<const deck::Name<FluidOptions::Type>> names(FluidOptions::Type);
[[nodiscard]] std::span<const deck::Name<OrificeRing::Inlet>> names(OrificeRing::Inlet);
[[nodiscard]] std::span<const deck::Name<WallOptions::Type>> names(WallOptions::Type);
[[nodiscard]] std::span<const deck::Name<Turbulence>> names(Turbulence);
void describe(deck::Description<ConstantViscosity>& d);
void describe(deck::Description<Sutherland>& d);
void describe(deck::Description<Vogel>& d);
void describe(deck::Description<Walther>& d);
void describe(deck::Description<Quadratic>& d);
void describe(deck::Description<ViscosityOptions>& d);
void describe(deck::Description<ConstantLaw>& d);
void describe(deck::Description<LinearLaw>& d);
void describe(deck::Description<PolynomialLaw>& d);
void describe(deck::Description<PowerLaw>& d);
void describe(deck::Description<PropertyOptions>& d);
void describe(deck::Description<FluidOptions>& d);
void describe(deck::Description<OrificeRing>& d);
void describe(deck::Description<SupplyGroove>& d);
void describe(deck::Description<WallOptions>& d);
void describe(deck::Description<Ambient>& d);

}  // namespace whirl::thermal
