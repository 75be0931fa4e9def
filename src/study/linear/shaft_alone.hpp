#pragma once
// Undamped modes of the shaft without its films: bending on pins or free, torsion, and along the axis.

#include "study/linear/modes.hpp"

namespace whirl::study {

/// Whether these modes are of the shaft alone.
[[nodiscard]] bool of_shaft_alone(const ModesOptions& options);

/// The frequencies with their bars, and the shapes of torsion and axial motion. Collective.
[[nodiscard]] StudyResult modes_of_shaft_alone(Context& context, const ModesOptions& options);

}  // namespace whirl::study
