#pragma once
// The same shaft of shorter elements.

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// The node of a divided shaft at the place of `node`; both 1-based.
[[nodiscard]] constexpr int node_after(int node, int parts) {
  return (node - 1) * parts + 1;
}

/// The shaft with every segment cut into `parts` equal ones; discs, hubs, masters and joints stay where they were. A
/// rigid rotor is itself. core::Bug of a shaft with couplings.
[[nodiscard]] Options divided(Options options, int parts);

}  // namespace whirl::rotor
