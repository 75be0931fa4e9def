#include "whirl/study/static.hpp"

namespace whirl::study {

void Static::run(Context&) {
  throw core::Error("study 'static' is not part of this build");
}

}  // namespace whirl::study
