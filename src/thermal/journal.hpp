#pragma once
// The journal within a film.

#include "whirl/thermal/solid.hpp"

namespace whirl::thermal {

/// A shaft, hollow or not, longer than the film. Where it rotates, its temperature is the same all around: it is taken
/// as a function of (r, z), and its surface, which all columns of a row of the film heat at once, as a cell of its own.
/// At rest it is a body like the bush.
struct Journal {
  Material material;
  bool rotating = true;
  double bore_radius = 0;  // m, 0 of a shaft that is not hollow
  double length = 0;       // m, from end to end
  double before = 0;       // m, from the end at the least z to the film
  int layers = 8;          // -
  double grading = 1;      // -, thickness of each layer over that of the one before it, from the film inwards
  double growth = 1;       // -, step along the shaft over the one before it, from the film on; the first is the film's
  Surfaces surfaces;       // inner: the bore; outer: beside the film
};

/// Conduction in a journal; options of its solver begin with `journal_`. Collective on the film's communicator. Throws
/// core::Error, on all ranks, if the film does not fit on the journal.
[[nodiscard]] Solid make_solid(const Rows& film, const Journal& journal);

}  // namespace whirl::thermal
