#pragma once
// The long film with an inlet at the top.

#include "film/closed/impedance.hpp"

namespace whirl::film {

/// p = 0 at theta = 90 deg, periodic, integrated where positive; |v| = 1.
Impedance long_inlet_film(const Pair& eccentricity, const Pair& squeeze);

}  // namespace whirl::film
