#pragma once
// Mass flow of a gas through an orifice.

namespace whirl::thermal {

struct Gas {
  double gas_constant = 286.7;  // J/(kg K)
  double heat_ratio = 1.4;      // -
};

/// kg/s and kg/(s Pa): a mass flow and its derivative in the pressure behind.
struct MassFlow {
  double value, slope;
};

/// Isentropic flow through an ideal nozzle per area [kg/(s m^2)] from `supply` [Pa] at `temperature` [K] to `pressure`,
/// both absolute: choked below the critical ratio, negative where the gas flows back. Within 1e-3 of equal pressures it
/// is linear, where the exact law has an infinite slope.
[[nodiscard]] MassFlow nozzle(const Gas& gas, double supply, double temperature, double pressure);

/// Discharge coefficient 0.85 (1 - exp(-8.2 h/d)) of an orifice of diameter d [m] without pocket over a film of
/// thickness h [m]. Source: Skarolek (2011) eq. (3.8), with the errata kept by this project.
[[nodiscard]] double discharge(double thickness, double diameter);

}  // namespace whirl::thermal
