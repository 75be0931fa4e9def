#include "run_studies.hpp"

#include "findings.hpp"
#include "premises.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/study/sweep/sweep.hpp"
#include "writer.hpp"

namespace whirl::study {
namespace {

// One study, and then those that its result calls for.
void run_one(Study& study, MPI_Comm comm, const Deck& deck, const Say& say, bool resume, Store& store) {
  if (!resume || !store.finished(study.name())) {
    Findings findings(comm, study.name(), std::string(study.kind()), store.checkpoint_path(study.name()), say);
    const auto part = [&](const std::string& name) { return store.checkpoint_path(study.name() + " " + name); };
    const LayoutOptions layout = layout_of(deck);
    Context context{comm,   deck.machine, layout, findings, store.studies(), store.summaries(),
                    resume, deck.studies, part};
    StudyResult result = result_of(study, context);
    put_premises(result, deck.machine, study);
    result.summary.brief = study.brief(result, store.summaries());
    io::typeset(result.summary.brief);
    store.add(std::move(result));
    if (findings.shows_progress()) say("", false);
  }
  for (const auto& more : study.further(store.studies().group(io::safe_name(study.name()))))
    run_one(*more, comm, deck, say, resume, store);
}

// Whether the study stands in the deck for the variants of a sweep only.
bool is_pattern(const Study& study, const Deck& deck) {
  bool pattern = false, needed = false, behind = false;
  for (const auto& s : deck.studies) {
    if (s.get() == &study) {
      behind = true;
      continue;
    }
    const auto* sweep = dynamic_cast<const Sweep*>(s.get());
    // A sweep repeats what stands before it.
    const bool repeats = behind && sweep && sweep->repeats(study.name());
    pattern = pattern || (repeats && !sweep->given().as_given);
    needed = needed || (repeats && sweep->given().as_given) || s->goes_on_from(study);
  }
  return pattern && !needed && study.kind() != Sweep::key;
}

}  // namespace

StudyResult result_of(Study& study, Context& context) {
  core::plan::Record record;
  try {
    StudyResult result = study.run(context);
    result.summary.ways = record.text();
    return result;
  } catch (const core::NotConverged& e) {
    // An answer that could not be had is a result with a reason; other studies go on.
    return context.results.finish(e.what(), false);
  } catch (const core::DomainError& e) {
    return context.results.finish(e.what(), false);
  }
}

void run_studies(MPI_Comm comm, const Deck& deck, const Say& say, bool resume, Store& store) {
  for (const auto& study : deck.studies)
    if (!is_pattern(*study, deck)) run_one(*study, comm, deck, say, resume, store);
}

std::vector<std::string> run(MPI_Comm comm, const Deck& deck, const RunOptions& options) {
  Writer writer(comm, deck, options);
  run_studies(comm, deck, options.say, options.resume, writer);
  writer.end();
  return writer.undelivered();
}

}  // namespace whirl::study
