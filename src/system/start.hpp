#pragma once
// Where Newton starts.

#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

/// A static guess: every journal held by a stiff spring slightly below its bearing centre (0.45 c_b), shaft and
/// pedestals at rest under their weight. One linear solve. Collective; the state has the layout of `system`.
[[nodiscard]] core::Vector static_guess(RotorSystem& system);

}  // namespace whirl::system
