#pragma once
// The bush around a film.

#include "whirl/thermal/solid.hpp"

namespace whirl::thermal {

/// A ring of conducting material from the film outwards, as long as the film, on its nodes.
struct Bush {
  Material material;
  double outer_radius = 0;  // m
  int layers = 8;           // -
  double grading = 1;       // -, thickness of each layer over that of the one before it, from the film outwards
  bool ring = true;   // of a pad: the bush closes around the journal, else it ends at the pad's ends, adiabatically
  Surfaces surfaces;  // inner: beside a pad, where there is no film
};

/// Conduction in a bush; options of its solver begin with `bush_`. Collective on the film's communicator. Throws
/// core::Error, on all ranks, if the bush is not outside the film.
[[nodiscard]] Solid make_solid(const Rows& film, const Bush& bush);

}  // namespace whirl::thermal
