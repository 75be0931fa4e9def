#pragma once
// One temperature for a whole film, by the heat balance of its volume: what a film without an energy equation can know.

#include <array>
#include <functional>

#include "whirl/thermal/fluid.hpp"

namespace whirl::thermal {

/// The least Prandtl number for which the temperature boundary layer is thinner than half of the clearance.
inline constexpr double least_lumped_prandtl = 8;

/// W/(m^2 K), h = 3/2 k/c Pr^(1/3) between a film of thickness c [m] and conductivity k [W/(m K)] and its wall.
/// Throws core::DomainError below Pr = 8, as of a gas. Source: Skarolek (2011) eq. (1.53).
[[nodiscard]] double wall_coefficient(double conductivity, double clearance, double prandtl);

/// A wall of the film; area 0 m^2 takes no heat.
struct LumpedWall {
  double area = 0;           // m^2
  double temperature = 300;  // K
};

/// What a film of one temperature draws in and dissipates.
struct LumpedFilm {
  double mass = 0;     // kg/s, that comes in
  double inlet = 300;  // K, the mean of it
  double heat = 0;     // W
};

/// W, c m (T_i - T) + Q + sum S h (T_w - T): what heats a film of temperature T [K]. Source: Skarolek (2011) eq.
/// (1.52).
[[nodiscard]] double lumped_balance(const Fluid& fluid, double clearance, const std::array<LumpedWall, 2>& walls,
                                    const LumpedFilm& film, double temperature);

/// K, where the balance is even, to 1e-7 K: `film` tells what the film does at a temperature. `start` K lies below.
/// Throws core::DomainError where a wall takes heat at Pr < 8, core::NotConverged where no temperature below 500 K
/// above `start` will do.
[[nodiscard]] double lumped_temperature(const Fluid& fluid, double clearance, const std::array<LumpedWall, 2>& walls,
                                        const std::function<LumpedFilm(double)>& film, double start);

}  // namespace whirl::thermal
