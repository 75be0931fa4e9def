#pragma once
// Rows of neighbouring ranks.

#include <vector>

#include "whirl/thermal/rows.hpp"

namespace whirl::thermal {

/// `own` [r, width] with the row before and the one behind [r + 2, width]; at the ends of the mesh these are zero.
/// Collective.
[[nodiscard]] std::vector<double> with_halo(const Rows& rows, const std::vector<double>& own, std::size_t width);

}  // namespace whirl::thermal
