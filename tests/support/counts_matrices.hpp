#pragma once
// Whether a solver assembles a machine's matrix.

#include "whirl/system/rotor_system.hpp"

namespace whirl::test {

/// A machine that knows how many matrices of it were asked for.
class CountsMatrices : public system::RotorSystem {
public:
  using RotorSystem::RotorSystem;
  int made = 0;
  [[nodiscard]] core::Matrix make_jacobian() override {
    ++made;
    return RotorSystem::make_jacobian();
  }
};

}  // namespace whirl::test
