#pragma once

#include <concepts>
#include <cstddef>

namespace whirl::core {

/// A signed index (int, PetscInt, Eigen::Index), known not to be negative, as the index of a standard container.
constexpr std::size_t at(std::integral auto i) {
  return static_cast<std::size_t>(i);
}

}  // namespace whirl::core
