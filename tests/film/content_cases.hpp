#pragma once
// Films whose content is their state, that several tests share.

#include <Eigen/SparseLU>
#include <array>
#include <string>
#include <vector>

#include "film/cases.hpp"
#include "film/sheet/hole.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film::testing {

inline Reynolds dynamic(std::array<int, 2> cells) {
  Reynolds o;
  o.cavitation = Reynolds::Cavitation::mass_conserving;
  o.states = Reynolds::States::dynamic;
  o.cells = cells;
  return o;
}
inline Reynolds without_states(Reynolds o) {
  o.states = Reynolds::States::condensed;
  return o;
}

/// Every bore that such a film may have.
struct ContentCase {
  std::string name;
  Geometry geometry;
  Reynolds options;
  std::array<double, 4> position, velocity;
};

inline std::vector<ContentCase> content_films() {
  const std::array<double, 4> loaded = {0.5, -0.4, 0.2, -0.15}, moving = {0.05, -0.08, 0.03, 0.02};
  const std::array<double, 4> shallow = {0.2, -0.6, 0.1, 0.1};
  Reynolds turbulent = dynamic({40, 12});
  turbulent.turbulence = Turbulence::constantinescu;
  Reynolds starved = dynamic({37, 11});
  starved.edge_fill = 0.7;
  Reynolds tilted = dynamic({23, 9});
  tilted.tilt = true;
  tilted.edge_fill = 0.9;
  Reynolds fed = dynamic({48, 12});
  fed.grooves = {{90.0 * kDegree, 20.0 * kDegree, 2e5}, {-30.0 * kDegree, 0.0, 0.0}};
  Reynolds holes = dynamic({40, 12});
  holes.grooves = {{90.0 * kDegree, 0.0, 1e5}};
  holes.holes = {{230.0 * kDegree, 0.01, 0.02, 3e5}, {-40.0 * kDegree, -0.015, 0.018, 0.0}};
  Reynolds line = dynamic({40, 10});
  line.inlet = {Inlet::Type::line, 100.0 * kDegree};
  Geometry offset = lemon();
  offset.offset = 0.4 * offset.clearance;
  return {{"lemon", lemon(), turbulent, loaded, moving},    {"lemon_tilted", offset, tilted, loaded, moving},
          {"arc_starved", arc(), starved, shallow, moving}, {"grooved", cylinder(), fed, shallow, moving},
          {"holes", cylinder(), holes, shallow, moving},    {"inlet_line", cylinder(), line, {0.3, -0.5}, moving}};
}

/// The states at which nothing changes while the journal moves as `m` says.
inline std::vector<double> settled(Film& film, const JournalMotion& m) {
  std::vector<double> q(film.states());
  film.unloaded(m, q);
  relax(film, m, q);
  return q;
}

/// dg/ds + sigma dg/ds' of the whole film.
inline Eigen::SparseMatrix<double> matrix_of(const Film& film, const StateResponse& r, double sigma) {
  const Share& all = film.whole();
  std::vector<Eigen::Triplet<double>> entries;
  for_entries(all, all.d_states, r.d_states, [&](int i, int j, double v) { entries.emplace_back(i, j, v); });
  for_entries(all, all.d_rates, r.d_rates, [&](int i, int j, double v) { entries.emplace_back(i, j, sigma * v); });
  Eigen::SparseMatrix<double> m(all.rows(), all.rows());
  m.setFromTriplets(entries.begin(), entries.end());
  return m;
}

/// Derivatives of the force with the states eliminated where they do not change.
struct Eliminated {
  std::array<std::array<double, 2>, 2> d_position, d_velocity;
  std::array<double, 2> d_speed;
};
inline Eliminated eliminate(const Film& film, const StateResponse& r) {
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(matrix_of(film, r, 0.0));
  const auto n = static_cast<Eigen::Index>(r.residual.size()), ports = r.forces.rows();
  Eigen::MatrixXd by(n, 5);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto s = static_cast<std::size_t>(k);
    by.row(k) << r.inputs(0, k), r.inputs(1, k), r.inputs(ports, k), r.inputs(ports + 1, k), r.d_speed[s];
  }
  const Eigen::MatrixXd through = -r.forces.topRows(2) * lu.solve(by).eval();
  Eliminated out;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (std::size_t j = 0; j < 2; ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      out.d_position[i][j] = r.journal.d_position[i][j] + through(row, column);
      out.d_velocity[i][j] = r.journal.d_velocity[i][j] + through(row, 2 + column);
    }
    out.d_speed[i] = r.journal.d_speed[i] + through(row, 4);
  }
  return out;
}

/// A step of e in a direction: 0 to 3 position, 4 to 7 velocity, 8 speed.
inline double step_of(const Geometry& g, int direction, double e) {
  const double tilt = g.clearance / g.length;
  return e * (direction == 8 ? 377.0 : direction % 4 < 2 ? g.clearance : tilt) * (direction / 4 == 1 ? 377.0 : 1.0);
}

/// Area [m^2] of the cell of every state, both halves of an aligned film; none under holes.
inline std::vector<double> cell_areas(const Geometry& g, const Reynolds& o) {
  const bool closed = g.type == Geometry::Bore::cylindrical, edges = !closed || o.inlet.type == Inlet::Type::line;
  const double step = (closed ? 2.0 * std::numbers::pi : g.arc) / o.cells[0];
  const bool whole = o.tilt || !o.holes.empty();
  const int rows = whole ? o.cells[1] - 1 : o.cells[1] / 2, pads = g.type == Geometry::Bore::lemon_bore ? 2 : 1;
  int columns = o.cells[0] - 1;
  if (!edges) {  // grooves
    const auto film = make_film(g, o, oil());
    columns = static_cast<int>(film->states()) / rows;
  }
  // Of holes in a bore with one groove, a line at the top: its columns start behind it.
  const Pad pad = make_pads(g, o.inlet).front();
  const HoleMesh holes = o.holes.empty() ? HoleMesh() : HoleMesh(pad, Grid(pad, o.cells), o.holes);
  std::vector<double> out;
  for (int i = 0; i < pads * columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const bool middle = o.cells[1] % 2 == 0 && j == rows - 1, under = !holes.empty() && holes.at(i + 1, j) > 0;
      out.push_back(g.radius * step * g.length / o.cells[1] * (under ? 0.0 : whole || middle ? 1.0 : 2.0));
    }
  return out;
}

}  // namespace whirl::film::testing
