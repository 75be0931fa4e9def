#include <memory>

#include "findings.hpp"
#include "whirl/core/error.hpp"
#include "whirl/study/deck.hpp"
#include "writer.hpp"

namespace whirl::study {
namespace {

// One study, and then those that its result calls for.
void run_one(Study& study, MPI_Comm comm, const Deck& deck, const RunOptions& options, Writer& writer) {
  if (!options.resume || !writer.finished(study.name())) {
    Findings findings(comm, study.name(), std::string(study.kind()), writer.checkpoint_path(study.name()), options.say);
    Context context{comm, deck.machine, findings, writer.studies(), options.resume, deck.studies};
    writer.add(result_of(study, context));
    if (findings.shows_progress()) options.say("", false);
  }
  for (const auto& more : study.further(writer.studies().group(io::safe_name(study.name()))))
    run_one(*more, comm, deck, options, writer);
}

}  // namespace

StudyResult result_of(Study& study, Context& context) {
  try {
    return study.run(context);
  } catch (const core::NotConverged& e) {
    // An answer that could not be had is a result with a reason; other studies go on.
    return context.results.finish(e.what(), false);
  } catch (const core::DomainError& e) {
    return context.results.finish(e.what(), false);
  }
}

std::vector<std::string> run(MPI_Comm comm, const Deck& deck, const RunOptions& options) {
  Writer writer(comm, options.directory, deck.machine.title, options.version, options.resume);
  for (const auto& study : deck.studies) run_one(*study, comm, deck, options, writer);
  return writer.undelivered();
}

}  // namespace whirl::study
