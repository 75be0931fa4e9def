#pragma once
// Facts of a shaft that need no linear algebra: lengths, masses, material, and the check of the options.

#include <optional>
#include <string_view>
#include <vector>

#include "whirl/rotor/freedom.hpp"
#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// Refuses options that describe no shaft. Throws core::InputError that names the segment, disc or master (1-based).
void validate(const Options& options);

/// Number of nodes: one more than segments; one of a rigid rotor.
[[nodiscard]] int n_nodes(const Options& options);

/// Axial positions of all nodes in m, from 0 at node 1.
[[nodiscard]] std::vector<double> node_positions(const Options& options);

/// E(T) in Pa by linear interpolation; throws core::DomainError for a temperature (K) outside a table of several
/// points.
[[nodiscard]] double modulus(const Material& material, double temperature);

/// Whether its diameters change along a segment.
[[nodiscard]] bool tapered(const Segment& segment);

/// The segment with the section at `place` (0 at the left end, 1 at the right one) all along it.
[[nodiscard]] Segment section_at(const Segment& segment, double place);

/// Mass of a segment in kg, shaft and added mass.
[[nodiscard]] double segment_mass(const Segment& segment, const Material& material);

/// The disc with its geometry turned into inertias: m = rho pi (Do^2 - Di^2) t/4, Jp = m (Do^2 + Di^2)/8,
/// Jd = Jp/2 + m t^2/12, added to those given.
[[nodiscard]] Disc resolved(const Disc& disc, const Material& material);

/// Length of the hub of a disc that has one, in m.
[[nodiscard]] double hub_length(const Disc& disc, const Options& options);

/// A force or a moment that turns with the shaft: on `freedom` (x or slope_x) Re(F) and on its partner in y Im(F),
/// F = amount (Omega^2 - i alpha) exp(i (angle + phase)), amount in kg m or kg m^2.
struct TurningForce {
  int node = 0;  // 1-based
  Freedom freedom = Freedom::x;
  double amount = 0;
  double phase = 0;  // rad
};

/// What eccentric and skewed discs do to the shaft: m e on the displacement, m e offset and (I_d - I_p) skew on the
/// tilt of the disc, there as a couple of forces where it has a hub. Source: Skarolek (2011), (1.75), with the terms of
/// the angular acceleration alpha.
[[nodiscard]] std::vector<TurningForce> disc_forces(const Options& options);

/// Mass of the rotor in kg.
[[nodiscard]] double total_mass(const Options& options);

/// Mass at each node in kg: half of each segment that ends there, and the discs; all of a rigid rotor at its one node.
[[nodiscard]] std::vector<double> node_masses(const Options& options);

/// Mass of the segments between nodes `from` < `to` and of the discs with from <= node < to, in kg: adjoining spans
/// share nothing.
[[nodiscard]] double mass_between(const Options& options, int from, int to);

/// Mass of the rotor `name` in kg: of the segments that have its name, and of the discs on their nodes; at a border
/// between two rotors, of those discs that name it. All of the shaft if its segments have one name or none, or if
/// `name` is empty; the mass of a rigid rotor.
[[nodiscard]] double mass_of(const Options& options, std::string_view name);

/// The first disc on a border of rotor `name` that names neither of the rotors that meet there, so that the mass of
/// this one is not known; empty if there is none.
[[nodiscard]] std::optional<std::size_t> disc_of_no_rotor(const Options& options, std::string_view name);

/// Slenderness L/D_eq of the span between two nodes, D_eq = sum(D_OS L)/sum(L) the mean of the outer stiffness
/// diameter. Source: Gavalas (2022), sec. 4.4, A_S read as the area of the longitudinal profile.
[[nodiscard]] double slenderness(const Options& options, int from, int to);

}  // namespace whirl::rotor
