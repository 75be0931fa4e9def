#pragma once
// What a run found, in the few lines that a user reads first.

#include <string>

#include "whirl/io/summary.hpp"

namespace whirl::app {

/// A line on a study (how it ended, points, time), its verdict and its warnings.
[[nodiscard]] std::string headline_text(const io::StudySummary& study);

/// What the study was asked for: the sentences and tables of its brief. Numbers have the digits that their uncertainty
/// leaves them.
[[nodiscard]] std::string answer_text(const io::StudySummary& study);

/// What is known of the machine at its service speed, a line each; empty if it has none.
[[nodiscard]] std::string service_text(const io::Service& service);

}  // namespace whirl::app
