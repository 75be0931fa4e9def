#pragma once
// The matrices of a rotor, reduced if asked.

#include <optional>
#include <vector>

#include "whirl/core/petsc.hpp"
#include "whirl/rotor/freedom.hpp"
#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// M q'' + (C + Omega G) q' + (K + Omega N) q = f, with q in m and rad, f in N and N m.
///
/// All are AIJ matrices on the rotor's communicator. Coordinates come in pairs (x, y) in natural order along the shaft
/// that does not depend on the number of ranks; each rank owns whole pairs (whole nodes if not reduced).
struct Matrices {
  core::Matrix mass;        // M, symmetric
  core::Matrix gyroscopic;  // G, skew, multiplied by Omega (rad/s); forward whirl is x -> y
  core::Matrix stiffness;   // K, symmetric
  core::Matrix damping;     // C = (stiffness_damping + internal_damping) K + D, D the damping of couplings
  // N = (internal_damping K + D) x [[0, 1], [-1, 0]], skew: what turning with the shaft makes of its damping, which
  // opposes q' - Omega e_z x q. It drives forward whirl slower than the shaft. Empty without such damping and without a
  // loss factor, which is in none of these matrices but takes its pattern.
  core::Matrix circulatory;
  core::Vector gravity;  // kg: nodal weights along -y per unit acceleration; multiply by g
  core::Matrix basis;    // T, q_full = T q, rows of inner freedoms of elements last; empty if not reduced. Loads reduce
                         // as T^T f_full.
  core::Vector offset;   // s^2: q_full = T q + g offset is the exact static shape under gravity; empty if not reduced
};

/// A rotor reduced in state space:
///
///     N u' + (P + Omega Q) u = L_v^T f,     q = R_q u + g offset,     v = R_v u
///
/// u has two entries for each coordinate: displacement and velocity of a master, or two of a mode, in m sqrt(kg). Row 2
/// i of a master is its momentum, row 2 i + 1 its velocity: u'_2i - u_2i+1 and what modes add to it, since q' = v holds
/// in the mean over L only. Each rank owns the rows of whole coordinates.
struct StateMatrices {
  core::Matrix rates, at_rest, turning;  // N, P, Q: what grows with Omega is gyroscopic and circulatory
  core::Vector gravity, across;          // kg, on the rows: multiply by g along -y, along x
  core::Matrix displacement, velocity;   // R_q, R_v, rows of full coordinates
  core::Matrix forces;                   // L_v, likewise
  core::Vector offset;                   // s^2, as Matrices::offset
};

/// How good a reduction is: vibration at frequency omega is followed with a relative error of order
/// (omega/neglected)^2 or better. Frequencies of the shaft with its masters held, rad/s; zero if not reduced. In state
/// space the moduli of its eigenvalues.
struct ReductionQuality {
  double retained = 0;   // highest kept fixed-interface frequency (zero for Guyan)
  double neglected = 0;  // lowest fixed-interface frequency left out; infinite if none is left out
};

/// A rotor assembled from beam elements and discs, or one rigid mass (x and y of node 1, owned by the first rank).
///
/// Full coordinates are those of full_coordinate(), then the pairs (x, y) of the inner freedoms of elements, which
/// have no node. Reduced coordinates are the pairs (x, y) of the master nodes in
/// ascending order of nodes, each followed by the pair (dx/dz, dy/dz) where slopes are masters too, then pairs of
/// mass-normalised fixed-interface modes in ascending order of frequency. Masters by K: T = [I; -K_ss^-1 K_sm] (Guyan
/// 1965), with modes Craig & Bampton (1968). Reduced in state space (`craig_bampton_state`) it has states() in place of
/// matrices(), and coordinates are pairs of states. Construction is collective on `comm`; throws core::InputError on
/// all ranks together.
class Rotor {
public:
  Rotor(MPI_Comm comm, const Options& options);

  /// All empty of a rotor reduced in state space.
  [[nodiscard]] const Matrices& matrices() const noexcept { return matrices_; }
  /// Of a rotor reduced in state space, else empty.
  [[nodiscard]] const std::optional<StateMatrices>& states() const noexcept { return states_; }
  /// C = (`value` + internal_damping) K + D [s]; all else stays. Not of a rotor reduced in state space, whose modes
  /// depend on C. Collective.
  void set_stiffness_damping(double value);
  /// Number of coordinates q.
  [[nodiscard]] PetscInt size() const noexcept { return size_; }
  [[nodiscard]] int n_nodes() const noexcept { return n_nodes_; }
  /// Index of the coordinate that is a freedom of `node` (1-based); -1 if it is not retained. Not collective; the same
  /// on all ranks.
  [[nodiscard]] PetscInt coordinate(int node, Freedom freedom) const;
  /// The freedom of a node that a coordinate is; empty of a mode and of an inner freedom.
  [[nodiscard]] std::optional<Freedom> freedom(PetscInt coordinate) const;
  [[nodiscard]] bool reduced() const noexcept { return reduced_; }
  [[nodiscard]] const ReductionQuality& quality() const noexcept { return quality_; }

private:
  void reduce_states(MPI_Comm comm, const Options& options);

  Matrices matrices_;
  std::optional<StateMatrices> states_;
  core::Matrix couplings_;  // D; empty without
  PetscInt size_ = 0;
  double internal_damping_ = 0;
  int n_nodes_ = 0;
  bool rigid_ = false, reduced_ = false;
  std::vector<int> masters_;  // freedoms of a plane, ascending
  ReductionQuality quality_;
};

/// What acts along -y, or moves there, turned to act along x: (a, b) of each pair (x, y) becomes (-b, a). A shaft of
/// circular section answers turned likewise. Collective.
[[nodiscard]] core::Vector turned(Vec pairs);
/// Weights per unit acceleration along x, as `gravity` of its matrices or states those along -y. Collective.
[[nodiscard]] core::Vector across(const Rotor& rotor);

}  // namespace whirl::rotor
