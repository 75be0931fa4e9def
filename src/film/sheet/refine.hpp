#pragma once
// Finer and coarser meshes.

#include <algorithm>
#include <cmath>

namespace whirl::film {

/// `factor` times as many cells, at least 4, and even if they must be.
[[nodiscard]] inline int refined(int cells, double factor, bool even) {
  if (factor == 1) return cells;
  const int finer = std::max(4, static_cast<int>(std::lround(cells * factor)));
  return even ? finer + finer % 2 : finer;
}

}  // namespace whirl::film
