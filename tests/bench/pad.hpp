#pragma once
// One pad of 60 x 16 cells that the benchmark programs measure, and its journal.

#include <numbers>

#include "whirl/film/contract/film.hpp"

namespace whirl::bench {

inline constexpr int kAround = 60, kAlong = 16;

inline film::Geometry one_pad() {
  return {film::Geometry::Bore::partial_arc, 0.2, 0.36, 0.0004, 160.0 * std::numbers::pi / 180.0, 0.5, 0.0};
}

/// Half of the pad is cavitated: a rupture line crosses the cells.
inline film::JournalMotion loaded(bool tilted) {
  film::JournalMotion m;
  m.position = {0.9 * 0.0004, -0.4 * 0.0004, tilted ? 1e-4 : 0.0, tilted ? -1e-4 : 0.0};
  m.velocity = {0.05 * 0.0004 * 377.0, -0.08 * 0.0004 * 377.0, 0.0, 0.0};
  m.speed = 377.0;
  return m;
}

/// The pad with heat.
inline film::Thd heated(int layers, film::States states) {
  film::Thd o;
  o.cells = {kAround, kAlong};
  o.layers = layers;
  o.states = states;
  o.feed = 323.15;
  o.viscosity = thermal::ViscosityOptions{thermal::Walther{{46e-6, 6.8e-6}, {313.15, 373.15}, 850.0}};
  return o;
}

}  // namespace whirl::bench
