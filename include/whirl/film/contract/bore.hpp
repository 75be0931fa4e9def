#pragma once
// What a fluid film stands in: the bore, where oil enters it, and the lubricant. Plain data, SI and radians.

#include <numbers>

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
  friend bool operator==(const Geometry&, const Geometry&) = default;
};

/// An axial groove of a bore, full of lubricant at a given pressure over the whole length.
struct Groove {
  double angle = 0.0;     // rad, of its middle
  double width = 0.0;     // rad, 0: a single line of nodes
  double pressure = 0.0;  // Pa, of the lubricant in it
  friend bool operator==(const Groove&, const Groove&) = default;
};

/// A round hole in a pad or bore through which lubricant comes under a given pressure.
struct Hole {
  double angle = 0.0;     // rad, of its middle
  double z = 0.0;         // m, of its middle, from the mid-plane of the bearing
  double diameter = 0.0;  // m
  double pressure = 0.0;  // Pa, of the lubricant in it
  friend bool operator==(const Hole&, const Hole&) = default;
};

/// Where the film of a full circle without grooves starts, at pressure zero over the whole length.
struct Inlet {
  /// free: the film reforms where cavitation lets it, around the whole circle. maximum_gap: where the film of the
  /// journal at that moment is thickest, in the mid-plane, so that the line turns with the journal (Raimondi and Boyd
  /// 1958). line: at an angle fixed in the bearing.
  enum class Type { free, maximum_gap, line };
  Type type = Type::free;
  double angle = 0.5 * std::numbers::pi;  // rad, of the line
  friend bool operator==(const Inlet&, const Inlet&) = default;
};

/// Isoviscous incompressible lubricant.
struct Lubricant {
  double viscosity = 0.0;  // Pa s, dynamic
  double density = 0.0;    // kg/m^3, enters only the Reynolds number of the turbulent film
  friend bool operator==(const Lubricant&, const Lubricant&) = default;
};

}  // namespace whirl::film
