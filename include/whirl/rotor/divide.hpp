#pragma once
// The same shaft of shorter elements.

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// The node of divided(whole, parts) at the place of `node` of `whole`; both 1-based.
[[nodiscard]] int node_after(const Options& whole, int node, int parts);

/// The shaft with every beam cut into `parts` equal ones; couplings, discs, hubs, masters and joints stay where they
/// were. A rigid rotor is itself.
[[nodiscard]] Options divided(Options options, int parts);

}  // namespace whirl::rotor
