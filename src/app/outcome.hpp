#pragma once
// What a run found, in the few lines that a user reads first.

#include <span>
#include <string>

#include "whirl/io/summary.hpp"

namespace whirl::app {

/// A line on a study (how it ended, points, time), its verdict and its warnings.
[[nodiscard]] std::string headline_text(const io::StudySummary& study);

/// A line for each bifurcation with what it means, for each point of codimension two and for each stretch that could
/// not be resolved, and then what the study was asked for. Numbers have the digits that their uncertainty leaves them.
/// `before` are the studies of the run that ended earlier.
[[nodiscard]] std::string answer_text(const io::StudySummary& study, std::span<const io::StudySummary> before = {});

/// What is known of the machine at its service speed, a line each; empty if it has none.
[[nodiscard]] std::string service_text(const io::Service& service);

}  // namespace whirl::app
