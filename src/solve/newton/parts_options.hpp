#pragma once
// Options that say how large the parts may be for a factorisation.

#include <fmt/format.h>

#include <string>

#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::solve {

/// Parts up to this size keep their factors from one frequency to the next, and with them the analysis of the pattern.
/// Factors of larger ones would fill the memory; where they have inverses of their own, these are used instead.
[[nodiscard]] inline PetscInt kept_states() {
  PetscInt states = 20000;
  core::check(PetscOptionsGetInt(nullptr, nullptr, "-parts_kept_states", &states, nullptr));
  return states;
}

/// Machines with up to this many states are factorised where approximate inverses of their parts do not serve.
[[nodiscard]] inline PetscInt whole_states() {
  PetscInt states = 1000000;
  core::check(PetscOptionsGetInt(nullptr, nullptr, "-parts_whole_states", &states, nullptr));
  return states;
}

/// What is said where a machine has more.
[[nodiscard]] inline std::string too_large(PetscInt states) {
  return fmt::format("the {} states of the machine are more than -parts_whole_states {} allows to factorise", states,
                     whole_states());
}

}  // namespace whirl::solve
