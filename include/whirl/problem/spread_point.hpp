#pragma once
// F and its derivatives, scaled, of a system that may be spread over ranks.

#include "whirl/problem/system.hpp"

namespace whirl::problem {

/// F/residual_scale as a function of x/state_scale and (dx/dt)/state_scale, this rank's rows. Collective on the
/// system's communicator.
class SpreadPoint {
public:
  /// `system` outlives this.
  explicit SpreadPoint(System& system);
  /// f = F(angle, x, xdot). Throws core::DomainError on all ranks.
  void residual(double angle, Vec x, Vec xdot, Vec f);
  /// m = alpha dF/dx + sigma dF/d(dx/dt); m is made if it is null.
  void jacobian(double angle, Vec x, Vec xdot, double alpha, double sigma, core::Matrix& m);
  /// f = dF/dp per SI unit of the parameter.
  void parameter_derivative(double angle, Vec x, Vec xdot, Vec f);
  [[nodiscard]] Vec state_scale() const { return state_scale_.get(); }
  /// The point of the last call in SI.
  [[nodiscard]] Vec x() const { return x_.get(); }
  [[nodiscard]] Vec xdot() const { return xdot_.get(); }

private:
  void put(Vec x, Vec xdot);
  System& system_;
  core::Vector state_scale_, residual_inverse_, x_, xdot_;
};

}  // namespace whirl::problem
