#pragma once
// Analytic films of a rigid, full, aligned bearing in impedance form, in clearances.

#include <array>

namespace whirl::film {

enum class ClosedForm { short_bearing, long_bearing, long_inlet, finite_approximate };

using Pair = std::array<double, 2>;  // x, y

/// F* = F/(mu L D (R/c)^2) of a journal at eccentricity e (clearances) with pure-squeeze velocity v_s = de/dt - (0, 0,
/// Omega/2) x e (1/s): F* = -|v_s| W with the impedance W(e, direction of v_s), and its exact derivatives.
struct Impedance {
  Pair force{};                          // 1/s
  std::array<Pair, 2> d_eccentricity{};  // [i][j] = dF*_i/de_j at constant v_s, 1/s
  std::array<Pair, 2> d_squeeze{};       // [i][j] = dF*_i/dv_s,j at constant e; F* = d_squeeze v_s
};

/// The film force of `kind`.
///
/// F* is homogeneous of degree one in v_s. At v_s = 0 the force and d_eccentricity are zero and d_squeeze is that of
/// the slowest rotation of the shaft (v_s in the direction (y, -x); +x for a centred journal). Regular for every |e| <
/// 1; throws core::DomainError otherwise. Source: van de Vrande (2001) sec. 4.1 and (4.42) with the errata kept by this
/// project; the closed forms in the axes of v_s are in the room's README.
Impedance impedance(ClosedForm kind, double length_to_diameter, const Pair& eccentricity, const Pair& squeeze);

/// p* (c/R)^2/(6 mu) in the mid-plane of the bearing at angle theta from +x, in 1/s, zero where it would be negative;
/// the finite_approximate film has none (core::Bug).
double mid_pressure(ClosedForm kind, double length_to_diameter, const Pair& eccentricity, const Pair& squeeze,
                    double theta);

}  // namespace whirl::film
