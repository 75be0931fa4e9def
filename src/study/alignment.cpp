#include "whirl/study/alignment.hpp"

namespace whirl::study {

void Alignment::run(Context&) {
  throw core::Error("study 'alignment' is not part of this build");
}

}  // namespace whirl::study
