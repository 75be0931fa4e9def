#pragma once
// Flow resistance of a turbulent film: the laws of films with heat.

#include "whirl/thermal/turbulence.hpp"

namespace whirl::film {

using thermal::couette_excess;
using thermal::couette_factor;
using thermal::evaluate;
using thermal::Resistance;
using thermal::resistance_along;
using thermal::resistance_around;
using thermal::Turbulence;

}  // namespace whirl::film
