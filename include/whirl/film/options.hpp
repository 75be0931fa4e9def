#pragma once
// What a fluid film is made of: bore, lubricant, and how its pressure is computed. Plain data, SI and radians.

#include <array>
#include <numbers>
#include <optional>
#include <vector>

namespace whirl::film {

/// Bore of a bearing. Every pad is a circular arc; a partial arc is centred at 270 deg, the lobes of a lemon bore at
/// 270 deg (lower) and 90 deg (upper). A cylindrical bore is one whole circle without edges.
struct Geometry {
  enum class Bore { partial_arc, lemon_bore, cylindrical };
  Bore type = Bore::partial_arc;
  double radius = 0.0;     // m, journal radius R
  double length = 0.0;     // m, axial length L
  double clearance = 0.0;  // m, assembled radial clearance c_b: thickness at the pad centre for a centred journal
  double arc = 0.0;        // rad, angular extent of each pad
  double preload = 0.0;    // -, m = 1 - c_b/c_p with c_p the machined (pad) clearance
  double offset = 0.0;     // m, horizontal distance between the lobe centres: lower +offset/2, upper -offset/2
};

/// A thin elastic layer on a rigid bore, in plane strain: U = k p, k = d (1 + nu)(1 - 2 nu)/(E (1 - nu)), nu not close
/// to 1/2. Source: van de Vrande (2001), sec. 4.2, after Higginson (1966).
struct Liner {
  double thickness = 0.0;  // m, d
  double modulus = 0.0;    // Pa, E
  double poisson = 0.0;    // -, nu
};

/// An axial groove of a bore, full of lubricant at a given pressure over the whole length.
struct Groove {
  double angle = 0.0;     // rad, of its middle
  double width = 0.0;     // rad, 0: a single line of nodes
  double pressure = 0.0;  // Pa, of the lubricant in it
};

/// Where the film of a full circle without grooves starts, at pressure zero over the whole length.
struct Inlet {
  /// free: the film reforms where cavitation lets it, around the whole circle. maximum_gap: where the film of the
  /// journal at that moment is thickest, in the mid-plane, so that the line turns with the journal (Raimondi and Boyd
  /// 1958). line: at an angle fixed in the bearing.
  enum class Type { free, maximum_gap, line };
  Type type = Type::free;
  double angle = 0.5 * std::numbers::pi;  // rad, of the line
};

/// Contact of rough surfaces: the asperities carry p_c = K E' F(h/sigma), F(x) = 4.4086e-5 (4 - x)^6.804 below x = 4,
/// none above. Source: Greenwood and Tripp (1971), with F fitted by Hu et al. (1994).
struct Contact {
  double roughness = 0.0;  // m, sigma: standard deviation of the heights of both surfaces
  double pressure = 0.0;   // Pa, K E'
};

/// How the film is modelled and discretised.
struct Options {
  enum class Kind {
    reynolds,
    linear,
    short_bearing,
    long_bearing,
    long_inlet,
    finite_approximate,
    compliant_short,
    compliant_long,
    compliant_finite
  };
  enum class Quadrature { sub_cell, simpson };
  enum class Differences { central, upwind, third_order };
  enum class Cavitation { half_sommerfeld, reynolds, mass_conserving, none };
  enum class Turbulence { laminar, constantinescu };
  enum class States { condensed, dynamic };
  Kind kind = Kind::reynolds;
  Cavitation cavitation = Cavitation::half_sommerfeld;
  Turbulence turbulence = Turbulence::laminar;
  Inlet inlet;                        // of a cylindrical bore
  double edge_fill = 1.0;             // -, part of the gap that is full of oil where it enters a pad (mass_conserving)
  States states = States::condensed;  // of a mass_conserving film: does its cavity fill and empty in time?
  double bulk_modulus = 1.5e9;        // Pa, of the oil where the gap is full, of a film with dynamic states
  std::array<int, 2> cells = {60, 16};                     // -, intervals around x along each pad
  bool tilt = false;                                       // -, false: tilt is ignored and moments are zero
  std::array<double, 4> stiffness = {0.0, 0.0, 0.0, 0.0};  // N/m, xx xy yx yy; linear film: force = -K d - C d'
  std::array<double, 4> damping = {0.0, 0.0, 0.0, 0.0};    // N s/m, xx xy yx yy
  // Compliant films: the liner, or B = 6 mu Omega_0 U R^2/(p c^3) with the speed Omega_0 that scales it.
  std::optional<Liner> liner;
  std::optional<double> compliance;        // -, B
  double reference_speed = 0.0;            // rad/s, Omega_0 of B
  double liner_damping = 0.0;              // s, tau: p = (p of the deflection at rest) + tau dU/dt/k
  std::optional<double> rubber_thickness;  // m, of a liner that stiffens as it is compressed
  std::optional<Contact> contact;          // absent: a film that touches is an error
  std::vector<Groove> grooves;
  Quadrature quadrature = Quadrature::sub_cell;    // of the force
  Differences differences = Differences::central;  // of dh/dtheta
};

/// Isoviscous incompressible lubricant.
struct Lubricant {
  double viscosity = 0.0;  // Pa s, dynamic
  double density = 0.0;    // kg/m^3, enters only the Reynolds number of the turbulent film
};

}  // namespace whirl::film
