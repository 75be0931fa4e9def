#pragma once
// The freedoms of a node of a shaft.

namespace whirl::rotor {

/// Displacements [m] and slopes dx/dz, dy/dz [-] of the section, in their order within a node. Forces [N] and moments
/// [N m] that do work with them stand in the same order.
enum class Freedom { x, y, slope_x, slope_y };
inline constexpr int freedoms_per_node = 4;

/// Place among the freedoms of all nodes of a whole shaft; `node` is 1-based.
[[nodiscard]] constexpr int full_coordinate(int node, Freedom freedom) {
  return freedoms_per_node * (node - 1) + static_cast<int>(freedom);
}
/// Which freedom stands there.
[[nodiscard]] constexpr Freedom freedom_at(int full_coordinate) {
  return static_cast<Freedom>(full_coordinate % freedoms_per_node);
}
[[nodiscard]] constexpr bool is_slope(Freedom freedom) {
  return freedom == Freedom::slope_x || freedom == Freedom::slope_y;
}

}  // namespace whirl::rotor
