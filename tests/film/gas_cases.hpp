#pragma once
// Films of gas that several tests share.

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "film/cases.hpp"
#include "film/use/steady.hpp"
#include "whirl/film/contract/film.hpp"

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
inline Gas self_acting(std::array<int, 2> cells) {
  Gas o;
  o.cells = cells;
  return o;
}

struct GasCase {
  std::string name;
  Geometry geometry;
  Gas options;
  std::array<double, 4> position, velocity;
};

inline std::vector<GasCase> gas_films() {
  const std::array<double, 4> loaded = {0.5, -0.4, 0.2, -0.15}, moving = {0.05, -0.08, 0.03, 0.02};
  Gas tilted = aerostatic(2, 6e5, {16, 8});
  tilted.tilt = true;
  Gas at_nodes = aerostatic(1, 4e5, {16, 6});
  at_nodes.source = Gas::Source::node;
  // Pockets of both kinds, not at nodes, with slip and a groove.
  Gas pockets = aerostatic(2, 6e5, {16, 8});
  pockets.tilt = true;
  pockets.slip = Gas::Slip::second;
  pockets.orifices[0].law = OrificeRow::Law::two_restrictors;
  pockets.orifices[0].diameter = 0.5e-3;  // so wide that the rim of its pocket resists too
  pockets.orifices[0].pocket = Pocket{0.7e-3, 300e-6};
  pockets.orifices[1].law = OrificeRow::Law::reynolds;
  pockets.orifices[1].pocket = Pocket{1e-3, 15e-6};
  pockets.orifices[1].angle = 0.13;
  pockets.grooves = {{2.0, 0.5, 2e5}};
  Gas lobed = aerostatic(1, 5e5, {18, 6});
  lobed.slip = Gas::Slip::first;
  lobed.lobes = Lobes{3, 0.3, 1.5 * std::numbers::pi};
  lobed.orifices[0].law = OrificeRow::Law::curtain;
  // As wide as oil needs.
  Geometry wide = spindle();
  wide.clearance = 200e-6;
  return {{"gas_one_row", wide, aerostatic(1, 5e5, {24, 6}), loaded, moving},
          {"gas_two_rows_tilted", wide, tilted, loaded, moving},
          {"gas_node_source", wide, at_nodes, loaded, moving},
          {"gas_pockets", wide, pockets, loaded, moving},
          {"gas_lobed", wide, lobed, loaded, moving},
          {"gas_self_acting", wide, self_acting({12, 5}), loaded, moving}};
}

/// At rest in its states, by Newton's method from a cold start.
struct SolvedGas {
  std::unique_ptr<Film> film;
  JournalMotion motion;
  std::vector<double> states;
  Response journal;
  FilmReport report;
  long factorisations;
};
/// Journal at `at` clearances.
inline SolvedGas solved(const Geometry& geometry, const Gas& options, std::array<double, 2> at, double speed) {
  SolvedGas out{make(geometry, options, air()), {}, {}, {}, {}, 0};
  out.motion.position = {at[0] * geometry.clearance, at[1] * geometry.clearance, 0.0, 0.0};
  out.motion.speed = speed;
  out.states.resize(out.film->states());
  out.film->unloaded(out.motion, out.states);
  const std::vector<double> rest(out.states.size(), 0.0);
  Steady steady(*out.film);
  steady.solve(out.motion, rest, Steady::Until::small_step, Need::force, out.states);
  out.journal = steady.here().journal;
  out.report = out.film->summary(out.motion, out.states);
  out.factorisations = steady.factorisations();
  return out;
}
inline double load_of(const SolvedGas& s) {
  return std::hypot(s.journal.force[0], s.journal.force[1]);
}

}  // namespace whirl::film::testing
