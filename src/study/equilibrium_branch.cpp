#include "whirl/study/equilibrium_branch.hpp"

namespace whirl::study {

void EquilibriumBranch::run(Context&) {
  throw core::Error("study 'equilibrium_branch' is not part of this build");
}

}  // namespace whirl::study
