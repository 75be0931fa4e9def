#pragma once
// The mesh of a solid beside a film, in cylindrical coordinates.

#include <cstddef>
#include <vector>

#include "whirl/thermal/mesh.hpp"

namespace whirl::thermal {

/// Layers k in r, columns i around, rows q along. Cells stand around the nodes (i, q): half a cell at z-ends and at the
/// ends of an open arc, so that these nodes lie on the surface. In r a cell lies between two faces. The film's nodes
/// are the columns from 0 on and the rows from film_row on.
struct Cylinder {
  std::vector<double> r;      // m [layers + 1], faces, ascending. A last layer of no thickness is the surface itself.
  std::vector<double> theta;  // rad [columns], ascending. One column: nothing changes around.
  std::vector<double> z;      // m [rows] from the film's mid-plane, ascending
  bool closed = true;         // column 0 follows the last one
  bool outside = true;        // the film wets the face r[0] of a bush that lies outside it, else the last of a journal
  int film_row = 0;

  [[nodiscard]] int layers() const { return static_cast<int>(r.size()) - 1; }
  [[nodiscard]] int columns() const { return static_cast<int>(theta.size()); }
  [[nodiscard]] int rows() const { return static_cast<int>(z.size()); }
  [[nodiscard]] bool axisymmetric() const { return theta.size() == 1; }
  /// m, where the temperature of a layer stands.
  [[nodiscard]] double centre(int k) const { return (r[at(k)] + r[at(k + 1)]) / 2; }
  /// rad / m, extent of the cells of a column / a row.
  [[nodiscard]] double angle(int i) const;
  [[nodiscard]] double depth(int q) const;
  /// m^2, of a face across z per radian; m^3 of a cell.
  [[nodiscard]] double sector(int k) const { return (r[at(k + 1)] - r[at(k)]) * centre(k); }
  [[nodiscard]] double volume(int k, int i, int q) const { return sector(k) * angle(i) * depth(q); }
  /// Layer and radius [m] of the wall.
  [[nodiscard]] int wall_layer() const { return outside ? 0 : layers() - 1; }
  [[nodiscard]] double wall_radius() const { return outside ? r.front() : r.back(); }

private:
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
};

/// Faces [layers + 1] from one radius to another, each layer `ratio` times as thick as the one before it.
[[nodiscard]] std::vector<double> graded(double from, double to, int layers, double ratio);
/// Distances from the end of a film, ascending to `length`: the first step is at most `step`, each at most `growth`
/// times as long as the one before it. Empty if length is 0.
[[nodiscard]] std::vector<double> beyond(double length, double step, double growth);
/// Angles [rad] of a film's nodes and, of a pad in a full ring, of others with about the same spacing in its gap.
[[nodiscard]] std::vector<double> columns_beside(const Mesh& film, bool ring);

/// Ends of the cells around nodes [n + 1], for output: halfway between neighbours, and at the first and the last node,
/// or, where the last is followed by the first after `period`, halfway between these.
[[nodiscard]] std::vector<double> cell_ends(const std::vector<double>& nodes, double period = 0);

}  // namespace whirl::thermal
