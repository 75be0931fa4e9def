#pragma once
// Taylor test of a System's derivatives.

#include "whirl/problem/system.hpp"

namespace whirl::problem {

/// How far the derivatives are from those of the residual: for steps h and h/2 along random directions, the remainder
/// |F(z + h dz) - F(z) - h J dz| must fall by four. All in scaled states and residuals.
struct TaylorReport {
  double state_order = 0;  ///< observed order in x, 2 if dF/dx is exact
  double rate_order =
      0;  ///< in dx/dt; F is linear in it, so the remainder itself is compared with round-off: 2 if it vanishes
  double parameter_order = 0;   ///< in p
  double first_difference = 0;  ///< size of F(z + h dz) - F(z): not zero if the test means anything
};

/// Tests dF/dx, dF/d(dx/dt) and dF/dp at (angle, x, xdot) with steps of `h` times the state scale. Collective on the
/// system's communicator.
[[nodiscard]] TaylorReport taylor_test(System& system, double angle, Vec x, Vec xdot, double h);

}  // namespace whirl::problem
