#pragma once
// Torsional and axial modes of a shaft.

#include "whirl/study/linear/modes.hpp"

namespace whirl::study {

/// The frequencies and shapes of `options.motion`, torsion or axial. Collective.
[[nodiscard]] StudyResult line_modes(Context& context, const ModesOptions& options);

}  // namespace whirl::study
