#include "whirl/study/modes.hpp"

namespace whirl::study {

void Modes::run(Context&) {
  throw core::Error("study 'modes' is not part of this build");
}

}  // namespace whirl::study
