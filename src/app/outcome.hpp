#pragma once
// What a run found, in the few lines that a user reads first.

#include <string>

#include "whirl/io/summary.hpp"

namespace whirl::app {

/// A line per study (how it ended, points, time). Below it one per bifurcation with what it means, per point of
/// codimension two and per stretch that could not be resolved, and then what the study was asked for. Numbers have the
/// digits that their uncertainty leaves them.
[[nodiscard]] std::string outcome_text(const io::Summary& summary);

}  // namespace whirl::app
