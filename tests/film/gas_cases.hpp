#pragma once
// Films of gas that several tests share.

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "film/cases.hpp"
#include "whirl/film/film.hpp"

namespace whirl::film::testing {

/// Bearings A (one row) and B (two rows at the quarters) of Skarolek (2011) sec. 3.3.
inline Geometry spindle() {
  return {Geometry::Bore::cylindrical, 0.015, 0.03, 20e-6, 0.0, 0.0, 0.0};
}
inline Lubricant air() {
  return {1.846e-5, 1.18};
}
inline Gas aerostatic(int rows, double supply, std::array<int, 2> cells) {
  Gas o;
  o.cells = cells;
  for (int r = 0; r < rows; ++r) o.orifices.push_back({8, rows == 1 ? 0.0 : (r - 0.5) * 0.015, 0.0, 0.2e-3, supply});
  return o;
}
/// Self-acting, of length L/D = ratio.
inline Gas self_acting(std::array<int, 2> cells) {
  Gas o;
  o.cells = cells;
  return o;
}

struct GasCase {
  std::string name;
  Gas options;
  std::array<double, 4> position, velocity;
};

inline std::vector<GasCase> gas_films() {
  const std::array<double, 4> loaded = {0.5, -0.4, 0.2, -0.15}, moving = {0.05, -0.08, 0.03, 0.02};
  Gas tilted = aerostatic(2, 6e5, {16, 8});
  tilted.tilt = true;
  Gas at_nodes = aerostatic(1, 4e5, {16, 6});
  at_nodes.source = Gas::Source::node;
  return {{"gas_one_row", aerostatic(1, 5e5, {24, 6}), loaded, moving},
          {"gas_two_rows_tilted", tilted, loaded, moving},
          {"gas_node_source", at_nodes, loaded, moving},
          {"gas_self_acting", self_acting({12, 5}), loaded, moving}};
}

}  // namespace whirl::film::testing
