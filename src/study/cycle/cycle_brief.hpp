#pragma once
// The answer of a branch of cycles.

#include "study/cycle/cycle_branch.hpp"

namespace whirl::study {

/// That of brief_of_branch(), the largest vibration, the vibrations at parameters asked for, and how far a rotor may be
/// disturbed below the threshold of a whirl that it jumps to.
[[nodiscard]] io::Brief brief_of_cycles(const StudyResult& result, const CycleBranchOptions& options);

}  // namespace whirl::study
