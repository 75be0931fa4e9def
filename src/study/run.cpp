#include <memory>

#include "results.hpp"
#include "whirl/core/error.hpp"
#include "whirl/study/deck.hpp"

namespace whirl::study {

std::vector<std::string> run(MPI_Comm comm, const Deck& deck, const RunOptions& options) {
  Results results(comm, options.directory, deck.machine.title, options.version, options.say, options.resume);
  Context context{comm, deck.machine, options.directory, results, options.resume, deck.studies};
  for (const auto& study : deck.studies) {
    const bool finished = options.resume && results.finished(study->name());
    if (finished && !study->resumes_itself()) continue;
    if (!finished) results.begin(study->name(), std::string(study->kind()));
    try {
      study->run(context);
    } catch (const core::NotConverged& e) {
      // An answer that could not be had is a result with a reason; other studies go on.
      results.finish(e.what(), false);
    } catch (const core::DomainError& e) {
      results.finish(e.what(), false);
    }
  }
  return results.undelivered();
}

}  // namespace whirl::study
