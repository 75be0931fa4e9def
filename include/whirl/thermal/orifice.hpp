#pragma once
// Mass flow of a gas through an orifice.

namespace whirl::thermal {

struct PerfectGas {
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
[[nodiscard]] MassFlow nozzle(const PerfectGas& gas, double supply, double temperature, double pressure);

/// Discharge coefficient 0.85 (1 - exp(-8.2 h/d)) of an orifice of diameter d [m] without pocket over a film of
/// thickness h [m]. Source: Skarolek (2011) eq. (3.8), with the errata kept by this project.
[[nodiscard]] double discharge(double thickness, double diameter);

/// A mass flow [kg/s] and its derivatives in `ideal` [-] and in `rate` [kg/s].
struct Discharged {
  double mass, by_ideal, by_rate;
};
/// What flows where the discharge coefficient falls with the flow's own Reynolds number: the largest root of
///
///     m = ideal (1 - exp(-rate sqrt(Re^2 + 1))),   Re = m/unit,
///
/// with `ideal` [kg/s] of either sign, unit = pi d mu/4 (orifice) or pi d mu (gap around a pocket) [kg/s]. The one
/// under the root lets a little flow pass below Re = 1, far outside the law's range, where without it nothing would
/// flow at all and the pressure between two restrictors would be unknown. Source: Skarolek (2011) eqs. (3.9)-(3.13),
/// after Belforte et al. (2007).
[[nodiscard]] Discharged discharged(double ideal, double rate, double unit);

}  // namespace whirl::thermal
