#pragma once
// The mesh of the shaft beside the one in use: every segment cut into shorter elements.

#include "whirl/system/options.hpp"
#include "whirl/system/train.hpp"

namespace whirl::study {

/// Order at which eigenvalues of beams converge with cubic elements, h^(2 (3 + 1 - 2)): twice what the displacement
/// exceeds the order of the strain energy's derivatives by. Source: Strang and Fix (1973), ch. 6.
inline constexpr double order_of_shaft = 4;

/// Whether the machine has a shaft of beams that can be cut: a shaft with couplings cannot.
[[nodiscard]] bool has_shaft_mesh(const system::Machine& machine);

/// The train with every segment of its shaft cut into `parts` equal ones; what stands at nodes stays in its place.
[[nodiscard]] system::Train with_cut_shaft(system::Train train, int parts);

}  // namespace whirl::study
