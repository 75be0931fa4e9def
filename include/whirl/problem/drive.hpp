#pragma once
// How the shaft turns while time passes.

#include <cmath>

namespace whirl::problem {

/// angle(t) = angle_0 + Omega_0 t + a t^2/2: constant speed, run-up (a > 0) or coast-down (a < 0).
struct Drive {
  double speed = 0;         ///< Omega_0 [rad/s]
  double acceleration = 0;  ///< a [rad/s^2]
  double angle = 0;         ///< angle_0 [rad]

  [[nodiscard]] double angle_at(double t) const { return angle + (speed + acceleration * t / 2) * t; }
  [[nodiscard]] double speed_at(double t) const { return speed + acceleration * t; }
  /// The first time at which the shaft has turned by `turned` [rad] since t = 0, on the way on which its speed keeps
  /// its sign; the form without cancellation, so that it holds for a = 0 too.
  [[nodiscard]] double time_of(double turned) const {
    return 2 * turned / (speed + std::copysign(std::sqrt(speed * speed + 2 * acceleration * turned), speed));
  }
};

}  // namespace whirl::problem
