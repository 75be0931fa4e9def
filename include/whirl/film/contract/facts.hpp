#pragma once
// What others may ask of a film without knowing its kind.

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

namespace whirl::film {

class Film;

/// How often the discrete force can be differentiated in the motion of the journal (and in the film's own states).
///
/// A film that cavitates on a mesh has a kink in one of its derivatives whenever the edge of the pressure passes a
/// node. Between two such passages it is smooth. The kinks shrink with the mesh, but a number that needs derivatives
/// beyond `derivatives` (a normal form needs three, an eigenvalue one and its slope in the parameter two) changes with
/// the place of the nodes: its error bar must say more than the difference of two meshes.
struct Smoothness {
  static constexpr int all = 100;  // a film in closed form
  int derivatives = all;           // of the force, that are continuous; 0: the force alone
  std::string_view reason;         // one clause, empty if all are continuous
  [[nodiscard]] bool smooth() const { return derivatives == all; }
};

/// Whether what a film remembers, the deflection of its liner or what its gap holds, changes in time by equations of
/// its own (dynamic) or is at every moment what the motion of the journal at that moment makes it (condensed).
enum class States { condensed, dynamic };

/// Why a film does not go with every bore.
struct CircleOnly {
  std::string_view option;  // of the film, that wants a whole circle; empty: the film goes with any bore
  std::string_view reason;  // what to say where the bore is none
};

/// An option of a film that does not fit the bore that was given, such as a hole outside all pads.
struct Misplaced {
  std::string option;  // its path among those of the film: "holes.2"; empty: none
  std::string reason;
};

/// What a film is like, from its options alone. A default one is a smooth film in closed form on a rigid bore.
struct Facts {
  bool coefficients = false;  // coefficients alone: no bore, no lubricant, no thickness, no pressure
  // Speeds at which they are known [rad/s], and whether those of the nearest end are kept beyond.
  std::array<double, 2> known_speeds{0, std::numeric_limits<double>::infinity()};
  bool holds_beyond = false;
  bool gives_way = false;       // the bore is elastic, so that the journal may go beyond the clearance
  bool asperities = false;      // they carry where journal and bore touch
  bool tilts = false;           // it follows the slope of the journal
  bool own_states = false;      // the film has states of its own
  bool force_by_rates = false;  // the force depends on the rates of the own states
  int states = 0;               // about how many own states
  int pads = 1;                 // that have a mesh each
  std::array<int, 2> cells{};   // of its mesh, around and along the bearing or each pad; 0: no mesh in this direction
  int mesh_order = 2;           // at which the error of the mesh falls
  Smoothness smoothness{};
  CircleOnly circle_only{};
  Misplaced misplaced{};  // found only if a bore was given
};

}  // namespace whirl::film
