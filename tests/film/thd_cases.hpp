#pragma once
// Films with heat that several tests share.

#include <array>
#include <string>
#include <vector>

#include "film/cases.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film::testing {

/// ISO VG 46 between a wall of 60 degC and an adiabatic one.
inline Thd heated(std::array<int, 2> cells, int layers) {
  Thd o;
  o.cells = cells;
  o.layers = layers;
  o.feed = 323.15;
  o.viscosity = thermal::ViscosityOptions{thermal::Walther{{46e-6, 6.8e-6}, {313.15, 373.15}, 850.0}};
  o.bush = {HeatedWall::Type::isothermal, 333.15};
  return o;
}

struct HeatedCase {
  std::string name;
  Geometry geometry;
  Thd options;
  std::array<double, 4> position, velocity;
};

inline std::vector<HeatedCase> heated_films() {
  const std::array<double, 4> loaded = {0.5, -0.4, 0.2, -0.15}, moving = {0.05, -0.08, 0.03, 0.02};
  const std::array<double, 4> shallow = {0.2, -0.6, 0.1, 0.1};
  Thd turbulent = heated({20, 7}, 1);
  turbulent.turbulence = Turbulence::constantinescu;
  turbulent.journal = {HeatedWall::Type::isothermal, 343.15};
  Thd tilted = heated({12, 7}, 3);
  tilted.tilt = true;
  Thd whole = heated({16, 8}, 4);
  whole.cavitation = Thd::Cavitation::none;
  whole.journal = {HeatedWall::Type::isothermal, 343.15};
  for (Thd* o : {&turbulent, &tilted, &whole}) o->states = States::dynamic;
  Geometry offset = lemon();
  offset.offset = 0.4 * offset.clearance;
  return {{"heated_lemon", lemon(), turbulent, loaded, moving},
          {"heated_lemon_tilted", offset, tilted, loaded, moving},
          {"heated_arc", arc(), whole, shallow, moving}};
}

}  // namespace whirl::film::testing
