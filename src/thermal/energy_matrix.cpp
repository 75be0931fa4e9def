// The derivative of the energy equation as a sparse matrix: the flux through each face over the temperatures of the two
// cells before it and the two behind it.
#include <array>

#include "thermal/energy_terms.hpp"
#include "whirl/core/index.hpp"

namespace whirl::thermal {

using core::at;

namespace {

// Flux = sum of `of` times the temperatures of far left, left, right, far right.
using Weights = std::array<double, 4>;

// Of conduction that changes with the temperature `tilt` is the same for both sides.
Weights weights(double carried, double conductance, double tilt, double upstream, double downstream) {
  const double u = carried * (1 + upstream - downstream), uu = -carried * upstream, d = carried * downstream;
  if (carried > 0) return {uu, u + conductance + tilt, d - conductance + tilt, 0};
  return {0, d + conductance + tilt, u - conductance + tilt, uu};
}

}  // namespace

void EnergyTerms::fill(Mat matrix) const {
  const Mesh& mesh = rows_.mesh();
  const int n = mesh.nodes_around(), l = mesh.across, rows = mesh.nodes_along();
  const double c = laws_.heat_capacity();
  const auto id = [&](int k, int i, int j) { return (static_cast<PetscInt>(j) * n + i) * l + k; };
  const auto own = [&](PetscInt cell) {
    const PetscInt j = cell / (static_cast<PetscInt>(n) * l);
    return j >= rows_.begin() && j < rows_.end();
  };
  const auto add = [&](PetscInt row, PetscInt column, double value) {
    core::check(MatSetValue(matrix, row, column, value, ADD_VALUES));
  };
  // cells: far left ... far right, -1 where there is none and the neighbour's share stands for it.
  const auto face = [&](Direction direction, std::size_t place, double flow, double conductance,
                        std::array<PetscInt, 4> cells, double share_left, double share_right) {
    const std::size_t d = at(static_cast<int>(direction));
    const bool limited = model_.order > 1 && !upstream_[d].empty();
    const bool varied = laws_.varied() && !capacity_[d].empty();
    const double capacity = varied ? static_cast<double>(capacity_[d][place]) : 1.0;
    const double conduct = varied ? conductance * static_cast<double>(conduct_[d][place]) : conductance;
    const double tilt = varied ? conductance * static_cast<double>(tilt_[d][place]) : 0.0;
    Weights w = weights(c * flow * capacity, conduct, tilt, limited ? static_cast<double>(upstream_[d][place]) : 0.0,
                        limited ? static_cast<double>(downstream_[d][place]) : 0.0);
    if (cells[0] < 0) w[1] += (1 - 2 * share_left) * w[0];
    if (cells[3] < 0) w[2] += (1 - 2 * share_right) * w[3];
    for (std::size_t s = 0; s < 4; ++s) {
      if (cells[s] < 0) continue;
      if (own(cells[1])) add(cells[1], cells[s], w[s]);
      if (own(cells[2])) add(cells[2], cells[s], -w[s]);
    }
  };
  const auto entry_share = [&](Direction d, bool last, int k, int i, int j) {
    return entering(d, last, k, i, j) > 0 ? 1.0 : 0.0;
  };
  const auto capacity_at = [&](PetscInt cell) { return laws_.varied() ? laws_.capacity(at_[at(cell)]) : 1.0; };
  const auto leaves = [&](Direction d, bool last, int k, int i, int j) {
    const double m = entering(d, last, k, i, j);
    if (m < 0) add(id(k, i, j), id(k, i, j), -c * m * capacity_at(rows_.cell(k, i, j)));
  };
  for (int j = rows_.begin(); j <= rows_.end(); ++j) {
    for (int i = 0; i < n && j > 0 && j < rows; ++i) {
      for (int k = 0; k < l; ++k) {
        const std::size_t place = at(rows_.cell(k, i, j));
        face(Direction::along, place, flow_.along[place], along(rows_.node(i, j)),
             {j > 1 ? id(k, i, j - 2) : -1, id(k, i, j - 1), id(k, i, j), j + 1 < rows ? id(k, i, j + 1) : -1},
             j > 1 ? 0 : entry_share(Direction::along, false, k, i, 0),
             j + 1 < rows ? 0 : entry_share(Direction::along, true, k, i, j));
      }
    }
    if (j == rows_.end()) break;
    for (int i = 0; i < n; ++i) {
      const PetscInt node = rows_.node(i, j);
      const int right = (i + 1) % n;
      for (int k = 0; k < l; ++k) {
        const PetscInt cell = id(k, i, j);
        const std::size_t place = at(rows_.cell(k, i, j));
        if (mesh.closed || i + 1 < n)
          face(Direction::around, place, flow_.around[place], around(node),
               {mesh.closed || i > 0 ? id(k, (i + n - 1) % n, j) : -1, cell, id(k, right, j),
                mesh.closed || i + 2 < n ? id(k, (i + 2) % n, j) : -1},
               mesh.closed || i > 0 ? 0 : entry_share(Direction::around, false, k, 0, j),
               mesh.closed || i + 2 < n ? 0 : entry_share(Direction::around, true, k, n - 1, j));
        if (k > 0) {
          const std::size_t layer = at(node) * at(l + 1) + at(k);
          face(Direction::across, layer, flow_.across[layer], across(node) * (mixing(node) ? mixing(node)[k] : 1.0),
               {k > 1 ? cell - 2 : -1, cell - 1, cell, k + 1 < l ? cell + 1 : -1}, wall_share(surroundings_.bush, node),
               wall_share(surroundings_.journal, node));
        }
        if (flow_.inflow[place] < 0) add(cell, cell, -c * flow_.inflow[place] * capacity_at(rows_.cell(k, i, j)));
        if (j == 0) leaves(Direction::along, false, k, i, j);
        if (j + 1 == rows) leaves(Direction::along, true, k, i, j);
        if (!mesh.closed && i == 0) leaves(Direction::around, false, k, i, j);
        if (!mesh.closed && i + 1 == n) leaves(Direction::around, true, k, i, j);
      }
      const auto wall = [&](bool journal, int k) {
        const double rise = laws_.varied() ? at_[at(rows_.cell(k, i, j))] : 0.0;
        add(id(k, i, j), id(k, i, j), wall_heat(journal, node, rise).slope);
      };
      wall(false, 0);
      wall(true, l - 1);
    }
  }
  core::check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  core::check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

}  // namespace whirl::thermal
