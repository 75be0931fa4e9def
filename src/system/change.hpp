#pragma once
// What of a machine differs between two values of a parameter.

#include <cstddef>
#include <vector>

#include "whirl/system/train.hpp"

namespace whirl::system {

/// Parts of a train that have other numbers than those of another one.
struct TrainChange {
  bool shaft = false;    ///< beams, discs, the mass of a rigid rotor: all matrices, load and unbalance
  bool damping = false;  ///< stiffness_damping alone, of a rotor whose basis does not depend on it
  bool joints = false;   ///< mass, damping or stiffness of pedestals and elements
  bool load = false;
  bool axes = false;  ///< of bearings that are aligned to the shaft
  bool unbalance = false;
  std::vector<std::size_t> films;  ///< bearings whose film is another one; elevations do not count
};

/// core::Bug unless both have the same shape: nodes, masters, bearings, pedestals.
[[nodiscard]] TrainChange change_between(const Train& from, const Train& to);

}  // namespace whirl::system
