#pragma once
// Bending of a shaft: moments and nominal stresses at the ends of its segments.

#include <array>
#include <complex>
#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::study {

/// One end of a segment. M = M_x + i M_y is the bending moment in the planes of x and y, sagging positive,
/// M = E I d(slope)/dz, and turns as
///
///     M(t) = still + forward exp(i Omega t) + backward exp(-i Omega t)
///
/// Stress by elementary beam theory, M/W (Timoshenko, Strength of Materials, Part I). To the shaft, which turns,
/// `forward` stands still; `still` goes round once and `backward` twice in a revolution.
struct BendingAt {
  int node = 0;                                   ///< 1-based
  double z = 0;                                   ///< [m]
  double outer = 0;                               ///< diameter of the stiffness outline [m]
  double modulus = 0;                             ///< W = pi (D^4 - d^4)/(32 D) [m^3]
  std::complex<double> still, forward, backward;  ///< [N m]
  std::complex<double> shear;                     ///< of what stands still, dM/dz [N]

  /// Amplitude of the stress of the fibre that feels most of it, (abs(still) + abs(backward))/W [Pa].
  [[nodiscard]] double alternating() const;
  /// Stress that stays in a fibre, abs(forward)/W at the most [Pa].
  [[nodiscard]] double mean() const;
  /// The largest stress of any fibre in a revolution, max abs(M(t))/W [Pa].
  [[nodiscard]] double largest() const;
};

/// A shape of all nodes [4 n_nodes]: x, y, dx/dz, dy/dz of each.
using ShaftShape = std::vector<double>;

/// Both ends of every beam of `shaft`, from left to right; couplings are left out. `still` is the shape at rest under
/// the accelerations `gravity` (x, y) [m/s^2]; `vibration` real and imaginary part of the complex amplitude at the
/// frequency of the speed [rad/s], or empty ones. Moments balance the forces at the nodes: of elements at rest they are
/// exact, of vibrations with consistent inertia. Throws core::DomainError as element_matrices() does.
[[nodiscard]] std::vector<BendingAt> bending_of(const rotor::Options& shaft, const ShaftShape& still,
                                                const std::array<double, 2>& gravity,
                                                const std::array<ShaftShape, 2>& vibration, double speed);

}  // namespace whirl::study
