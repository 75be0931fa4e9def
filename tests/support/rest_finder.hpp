#pragma once
// Static equilibria for elements that carry no static load, by Newton's method alone.

#include "whirl/core/error.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::test {

class NewtonRest : public system::RestFinder {
public:
  void find(system::RotorSystem& machine, Vec x, bool near) const override {
    if (!near) core::check(VecCopy(machine.guess().get(), x));
    const auto result = solve::find_equilibrium(machine, x, {});
    if (!result.converged) throw core::NotConverged(result.reason);
  }
};

inline const NewtonRest newton_rest;

}  // namespace whirl::test
