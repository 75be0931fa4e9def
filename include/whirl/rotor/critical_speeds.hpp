#pragma once
// Undamped critical speeds of a shaft on springs.

#include <array>
#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// Whether the shaft whirls with its rotation or against it.
enum class Whirl { forward, backward };

/// What a spring of the shaft stands on: a mass on springs to the ground, in x and y [kg, N/m].
struct Stand {
  std::array<double, 2> mass{}, stiffness{};
};

/// A spring at a node (1-based), on the ground or on a stand (`stand` its place in a list of them, or -1).
struct SpringAt {
  int node = 0;
  int stand = -1;
};

/// The lowest `count` speeds [rad/s], ascending, at which the undamped and unreduced shaft whirls at its own speed on
/// isotropic springs of `stiffness` [N/m], at least two: K v = Omega^2 (M -+ G) v with the matrices of one plane and
/// the displacements of the stands. Where a stand is not the same in x and y, x = u cos and y = v sin of the angle:
///
///     [ K_x     ] [ u ]           [  M  -G ] [ u ]
///     [     K_y ] [ v ] = Omega^2 [ -G   M ] [ v ]      forward where u' M v >= 0, which counts motion on a line in
///
/// Fewer where inertia leaves fewer: discs whose polar inertia is the larger one lift forward ones to infinity. Dense,
/// 20 n^3 operations for n freedoms of a plane, or of both. Not collective; throws core::InputError.
[[nodiscard]] std::vector<double> critical_speeds(const Options& options, const std::vector<SpringAt>& springs,
                                                  double stiffness, Whirl whirl, int count,
                                                  const std::vector<Stand>& stands = {});

}  // namespace whirl::rotor
