#pragma once
// How large the vibration is at the service speed by the studies that compute it: facts named "largest vibration", one
// a journal or node, and "thinnest film".

#include <vector>

#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Half of the travel of the journals, and the thinnest film, in the cycles that a branch computed at `speed` [rad/s].
[[nodiscard]] std::vector<io::ServiceFact> facts_of_cycles(const io::StudySummary& s, const io::Group& group,
                                                           double speed);
/// Half of the travel of the journals in a motion in time.
[[nodiscard]] std::vector<io::ServiceFact> facts_of_motion(const io::StudySummary& s, const io::Group& group);
/// The amplitude with which a run-up of two rows at least passes the speed, or ends just below it.
[[nodiscard]] std::vector<io::ServiceFact> facts_of_run_up(const io::StudySummary& s, const io::Group& group,
                                                           double speed);

}  // namespace whirl::study
