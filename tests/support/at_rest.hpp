#pragma once
// The equilibrium of a machine.

#include <gtest/gtest.h>

#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::test {

/// Without its forcing, from its own first guess. Collective.
inline core::Vector equilibrium(system::RotorSystem& s) {
  s.set_forcing(false);
  core::Vector x = s.guess();
  solve::NewtonOptions o;
  o.max_iterations = 60;
  const auto r = solve::find_equilibrium(s, x.get(), o);
  EXPECT_TRUE(r.converged) << r.reason << " after " << r.iterations << ", residual " << r.residual;
  s.set_forcing(true);
  return x;
}

}  // namespace whirl::test
