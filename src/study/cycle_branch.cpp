#include "whirl/study/cycle_branch.hpp"

namespace whirl::study {

void CycleBranch::run(Context&) {
  throw core::Error("study 'cycle_branch' is not part of this build");
}

}  // namespace whirl::study
