#include "results.hpp"
#include "whirl/study/deck.hpp"

namespace whirl::study {

core::Exit run(MPI_Comm comm, const Deck& deck, const RunOptions& options) {
  Results results;
  Context context{comm, deck.machine, options.directory, results, options.progress, options.resume};
  for (const auto& s : deck.studies) s->run(context);
  return core::Exit::success;
}

}  // namespace whirl::study
