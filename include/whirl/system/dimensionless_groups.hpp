#pragma once
// The nondimensional groups that a rigid rotor in equal bearings depends on.

#include <optional>

#include "whirl/system/train.hpp"

namespace whirl::system {

/// Omega_0 = sqrt(F0/(m c)), F0* = (c/R)^2 F0/(mu Omega_0 L D), a* = U/(m c), with F0 the load of the whole rotor
/// (weight and static load) and U its unbalance. Source: van de Vrande (2001), sec. 5.1.
struct DimensionlessGroups {
  double speed_scale = 0;         ///< Omega_0 [rad/s]; Omega* = Omega/Omega_0
  double load = 0;                ///< F0* [-]
  double unbalance = 0;           ///< a* [-]
  double length_to_diameter = 0;  ///< [-]
  int bearings = 1;               ///< [-]

  /// S = F0*/(n Omega*) of one of the n bearings.
  [[nodiscard]] double sommerfeld(double speed) const { return load * speed_scale / (bearings * speed); }
};

/// The load of a rigid rotor, weight and static loads [N]: downwards, or its magnitude where it has a part along x.
[[nodiscard]] double load_of_rigid(const Train& train);

/// Empty unless the rotor is rigid, loaded but not upwards, and all its bearings have the same geometry, film and
/// viscosity.
[[nodiscard]] std::optional<DimensionlessGroups> dimensionless_groups(const Train& train);

}  // namespace whirl::system
