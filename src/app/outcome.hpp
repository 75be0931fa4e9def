#pragma once
// What a run found, in the few lines that a user reads first.

#include <string>

#include "whirl/io/summary.hpp"

namespace whirl::app {

/// A line per study (how it ended, points, time) and below it one per bifurcation, per point of codimension two and per
/// stretch that could not be resolved. Numbers have the digits that their uncertainty leaves them.
[[nodiscard]] std::string outcome_text(const io::Summary& summary);

}  // namespace whirl::app
