#pragma once
// What a user says about a rotor. Plain data in SI; nodes are 1-based, node k is the left end of segment k.

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace whirl::rotor {

/// One Timoshenko beam element of circular section. The material outline gives mass and inertia, the (possibly smaller)
/// stiffness outline bends; added mass has no stiffness and is spread uniformly over the length.
struct Segment {
  std::string rotor;               // name of the rotor it belongs to (HP, GEN, ...)
  std::string part;                // name of the shaft portion
  double length = 0;               // m
  double outer_mass_diameter = 0;  // m
  double inner_mass_diameter = 0;  // m
  // At the right end, where the segment is tapered: diameters are linear between the ends.
  std::optional<double> right_outer_diameter{}, right_inner_diameter{};
  double outer_stiffness_diameter = 0;   // m; 0: both stiffness diameters equal the mass diameters
  double inner_stiffness_diameter = 0;   // m
  double added_mass = 0;                 // kg in the whole element
  double added_mass_inner_diameter = 0;  // m, annulus of the added mass
  double added_mass_outer_diameter = 0;  // m
  double temperature = 293.15;           // K
  friend bool operator==(const Segment&, const Segment&) = default;
};

/// A rigid disc at a node. Inertias are given directly, by geometry (outer_diameter > 0), or both: then they add.
struct Disc {
  int node = 0;                  // 1-based
  double mass = 0;               // kg
  double polar_inertia = 0;      // kg m^2, about the axis of the disc
  double diametral_inertia = 0;  // kg m^2, about a diameter through the centre of mass
  double outer_diameter = 0;     // m; 0: no geometry
  double inner_diameter = 0;     // m, bore
  double thickness = 0;          // m
  double density = 0;            // kg/m^3; 0: that of the shaft material
  double offset = 0;             // m, of the centre of mass from the node along the shaft
  // What turns with the shaft and forces it: distance of the centre of mass from the axis of the shaft, and tilt of the
  // axis of the disc against it, each with the angle of its direction from +x at shaft angle zero.
  double eccentricity = 0, eccentricity_phase = 0;  // m, rad
  double skew = 0, skew_phase = 0;                  // rad
  // Nodes at both ends of its hub: the disc then tilts as the line through them. Empty: as the section at its node.
  std::vector<int> hub{};
  std::string rotor{};  // name of the rotor it belongs to; that of the segments at its node if empty
  friend bool operator==(const Disc&, const Disc&) = default;
};

/// Material of the shaft. The modulus is linear between the points of the table; one point means a constant.
struct Material {
  double density = 7850;                           // kg/m^3
  double poisson = 0.3;                            // -
  std::vector<std::pair<double, double>> modulus;  // (K, Pa), temperatures ascending
  double shear_modulus = 0;                        // Pa, at every temperature; 0: E(T) / (2 (1 + poisson))
  friend bool operator==(const Material&, const Material&) = default;
};

/// Which shear coefficient kappa enters Phi = 12 E I / (kappa G A L^2).
enum class Shear {
  cowper_solid,   // 6 (1 + nu) / (7 + 6 nu), also for hollow sections
  cowper_hollow,  // Cowper (1966), hollow circle with the bore of the stiffness outline
  rigid           // Phi = 0: Rayleigh beam
};

/// Which beam element a segment is.
enum class BeamElement {
  rayleigh,             // cubic, no shear: Phi = 0
  timoshenko,           // one shear angle, that of the static solution without load on the span
  timoshenko_linear,    // shear angle and curvature each linear and independent: two inner freedoms
  timoshenko_hermitian  // displacement and slope each cubic and independent: shear angle and curvature at the ends
};

/// A flexible coupling in the place of a beam: two rigid halves, each on one end of its segment and with the mass of
/// half the segment, joined by springs and dashpots that turn with the shaft. Between the halves, half way along the
/// segment, k and c act on the offset of the axes and on the angle between them.
struct Coupling {
  int segment = 0;                 // 1-based
  double stiffness = 0;            // N/m
  double tilt_stiffness = 0;       // N m/rad
  double damping = 0;              // N s/m
  double tilt_damping = 0;         // N m s/rad
  double torsional_stiffness = 0;  // N m/rad, of torsion alone
  double axial_stiffness = 0;      // N/m, of motion along the shaft alone
  friend bool operator==(const Coupling&, const Coupling&) = default;
};

/// In whose frame hysteresis sees a vibration: that of the shaft, which turns, or the stationary one.
enum class LossFrame { shaft, stationary };

/// Reduction of the coordinates. Masters are both translations of each master node, and both slopes of some of them.
struct Reduction {
  enum class Type { none, guyan, craig_bampton, craig_bampton_state, modal };
  Type type = Type::none;
  std::vector<int> masters;  // 1-based nodes, at least two, any order
  // craig_bampton: fixed-interface modes per plane (each gives an x and a y coordinate). craig_bampton_state: half as
  // many as pairs of complex modes of both planes. modal: real modes of the shaft at rest per plane, at least as many
  // as masters, whose motions are among theirs.
  int modes = 0;
  double support = 0;         // N/m, modal: springs at the masters while its modes are computed; 0: the free shaft
  double speed = 0;           // rad/s, craig_bampton_state: of the shaft while its modes are computed
  std::vector<int> slopes{};  // those of the masters whose slopes are masters too; no key of a deck
  friend bool operator==(const Reduction&, const Reduction&) = default;
};

/// A shaft of beam elements, or a rigid body without tilt: node 1 with x and y only.
struct Options {
  enum class Type { shaft, rigid };
  Type type = Type::shaft;
  double mass = 0;  // kg, rigid
  double load = 0;  // N, rigid: static force along -y beside the weight
  std::vector<Segment> segments;
  std::vector<Disc> discs;
  std::vector<Coupling> couplings{};
  Material material;
  Shear shear = Shear::cowper_solid;
  BeamElement element = BeamElement::timoshenko;
  // 1-based nodes where forces from outside act (films, unbalance), so that shear force or bending moment may jump;
  // those of discs and steps need not be named. No key of a deck; only timoshenko_hermitian asks for it.
  std::vector<int> joints{};
  double stiffness_damping = 0;  // s, C = stiffness_damping * K in the stationary frame
  double internal_damping = 0;   // s, viscous damping of the material, which turns with the shaft
  double loss_factor = 0;  // eta, hysteretic damping of shaft and couplings: of vibration with one frequency alone
  LossFrame loss_frame = LossFrame::shaft;
  Reduction reduction;
  friend bool operator==(const Options&, const Options&) = default;
};

}  // namespace whirl::rotor
