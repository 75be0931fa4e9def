#pragma once
// The mesh of a fluid film, unwrapped: around and along the bearing and, layer by layer, across the film.

#include <numbers>

namespace whirl::thermal {

/// A full bore or a pad. Pressure stands at nodes (i, j); a control volume stands around each of them, half a volume at
/// ends. Temperature stands in cells (k, i, j): the volume of node (i, j), cut into `across` layers of equal thickness,
/// k = 0 at the bush, where zeta = 0, and k = across - 1 at the journal, where zeta = 1.
struct Mesh {
  int around = 96, along = 32;           // -, intervals; a closed film has `around` nodes, a pad one more
  int across = 8;                        // -, layers
  bool closed = true;                    // the film closes around the journal
  double radius = 0;                     // m, of the journal
  double length = 0;                     // m, along the shaft
  double begin = 0;                      // rad, of node 0, from +x counter-clockwise
  double extent = 2 * std::numbers::pi;  // rad

  [[nodiscard]] int nodes_around() const { return closed ? around : around + 1; }
  [[nodiscard]] int nodes_along() const { return along + 1; }
  /// m, between nodes around / along.
  [[nodiscard]] double dx() const { return radius * extent / around; }
  [[nodiscard]] double dz() const { return length / along; }
  /// rad / m from the mid-plane, of a node.
  [[nodiscard]] double theta(int i) const { return begin + extent * i / around; }
  [[nodiscard]] double z(int j) const { return length * (static_cast<double>(j) / along - 0.5); }
  /// m, width of the volume of a node around / along: half of it at an end.
  [[nodiscard]] double width(int i) const { return !closed && (i == 0 || i == around) ? dx() / 2 : dx(); }
  [[nodiscard]] double depth(int j) const { return j == 0 || j == along ? dz() / 2 : dz(); }
};

}  // namespace whirl::thermal
