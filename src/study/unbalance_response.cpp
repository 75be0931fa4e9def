#include "whirl/study/unbalance_response.hpp"

namespace whirl::study {

void UnbalanceResponse::run(Context&) {
  throw core::Error("study 'unbalance_response' is not part of this build");
}

}  // namespace whirl::study
