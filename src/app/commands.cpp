#include "commands.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "cells.hpp"
#include "directory.hpp"
#include "outcome.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/core/printable.hpp"
#include "whirl/core/session.hpp"
#include "whirl/deck/output.hpp"
#include "whirl/io/checkpoint.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/study/deck.hpp"
#include "whirl/study/stop.hpp"
#include "whirl/study/sweep/sweep.hpp"

namespace whirl::app {
namespace {

namespace fs = std::filesystem;

// "1 bearing", "2 bearings"
std::string count(std::size_t n, const std::string& what, const std::string& plural) {
  return fmt::format("{} {}", n, n == 1 ? what : plural);
}

// What `--set` did, a line per value.
std::string changes_text(const std::vector<deck::Change>& changes) {
  constexpr std::size_t most = 20;
  constexpr std::size_t longest = 60, beside = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, changes.size()); ++i) {
    const std::string &after = changes[i].after, &before = changes[i].before;
    // Long values from a little before their first difference on.
    const auto apart = static_cast<std::size_t>(std::ranges::mismatch(after, before).in1 - after.begin());
    auto brief = [&](const std::string& s) {
      if (s.size() <= longest) return s.empty() ? std::string("nothing") : s;
      const std::size_t from = apart + beside > longest ? apart - beside : 0;
      return (from > 0 ? "..." : "") + s.substr(from, longest) + (from + longest < s.size() ? "..." : "");
    };
    text += paragraph(fmt::format("set {}: {}, was {}", changes[i].path, brief(after), brief(before)), 2);
  }
  if (changes.size() > most) text += fmt::format("  and {} more values\n", changes.size() - most);
  return core::printable(text);
}

// What is unusual about a deck, a line each.
std::string warnings_text(const study::Deck& deck) {
  const std::vector<std::string> warnings = study::warnings(deck);
  constexpr std::size_t most = 20;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, warnings.size()); ++i) text += paragraph("warning: " + warnings[i], 2);
  if (warnings.size() > most) text += fmt::format("  and {} more warnings\n", warnings.size() - most);
  return text;
}

// An InputError that does not depend on the rank is one that all ranks have.
[[noreturn]] void refuse(const std::string& text) {
  core::InputError e(text);
  e.mark_agreed();
  throw e;
}

// Of the sources that the program was built in, or of an installation.
std::string report_command() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return !error && fs::exists(program.parent_path().parent_path() / "scripts" / "report", error) ? "scripts/report"
                                                                                                 : "whirl-report";
}

}  // namespace

core::Exit run(MPI_Comm comm, const RunRequest& request, const Print& print) {
  const study::Deck deck = study::load(comm, request.deck.path, request.deck.overrides);
  if (deck.studies.empty()) refuse(fmt::format("{}: the deck asks for no study (`studies: [...]`)", request.deck.path));
  if (request.resume && request.force)
    refuse("--resume goes on with earlier results, --force replaces them: choose one");
  const std::string directory =
      request.directory.empty() ? "results/" + fs::path(request.deck.path).stem().string() : request.directory;
  const Earlier earlier = request.resume ? Earlier::resume : request.force ? Earlier::replace : Earlier::refuse;
  std::vector<std::string> files;
  for (const auto& s : deck.studies)
    for (const char* kind : {io::Checkpoint::ending, ".xdmf", ".unwrapped.xdmf"})
      files.push_back(io::safe_name(s->name()) + kind);
  Directory held(comm, directory, study::resolved_text(deck), earlier, files);
  study::RunOptions options{directory, WHIRL_VERSION, {}, {}, request.resume};
  std::size_t ended = 0;
  if (request.progress)
    options.say = [&](const std::string& line, bool /*transient*/) {
      const std::string where = line.empty() ? "" : fmt::format("{} of {} studies done, ", ended, deck.studies.size());
      fmt::print(stderr, "\r\033[K{}", (where + line).substr(0, widest_line() - 1));
    };
  // With a service speed what is known there comes before the answers of the studies, which need not wait to be seen
  // in the files.
  const bool opens_with_service = deck.machine.service_speed.has_value();
  std::string answers;
  options.ended = [&](const io::StudySummary& s) {
    if (request.progress) fmt::print(stderr, "\r\033[K");
    // A branch that another one calls for is no study of the deck.
    ended += std::ranges::any_of(deck.studies, [&](const auto& study) { return study->name() == s.name; });
    const std::string answer = answer_text(s);
    print(headline_text(s) + (opens_with_service ? "" : answer));
    if (opens_with_service && !answer.empty()) answers += fmt::format("{}:\n{}", s.name, answer);
  };
  std::string text = changes_text(deck.changes);
  print(text + warnings_text(deck));
  text.clear();
  study::stop_after_checkpoints(request.stop_after_checkpoint);
  std::vector<std::string> undelivered;
  try {
    undelivered = study::run(comm, deck, options);
  } catch (const core::InputError&) {
    held.abandon();
    throw;
  } catch (...) {
    print(answers);
    throw;
  }
  std::string closing;
  core::agree(comm, [&] {
    if (core::rank_of(comm) != 0) return;
    const io::Summary all = io::Summary::read(fs::path(directory) / "summary.json");
    text += service_text(all.service) + answers;
    std::size_t warnings = all.warnings.size();
    for (const io::StudySummary& s : all.studies) warnings += s.warnings.size();
    closing = paragraph(fmt::format("results in {}{}; {} {} writes tables and pictures on one page", directory,
                                    warnings == 0 ? "" : " with " + count(warnings, "warning", "warnings"),
                                    report_command(), directory),
                        0);
  });
  for (const auto& o : core::Session::options_in_force())
    if (o.source != "command line")
      text += fmt::format("PETSc option {}{} from {} was in force\n", o.name, o.value.empty() ? "" : " " + o.value,
                          o.source.empty() ? "an unknown source" : o.source);
  for (const std::string& option : core::Session::unused_options())
    text += fmt::format("nothing has asked for the PETSc option {}\n", option);
  if (core::rank_of(comm) == 0 && !held.locked())
    text += fmt::format("'{}' cannot be locked: nothing would have kept a second run out\n", directory);
  print(text + closing);
  return undelivered.empty() ? core::Exit::success : core::Exit::not_delivered;
}

namespace {

std::string checked(MPI_Comm comm, const DeckRequest& request) {
  const study::Deck deck = study::load(comm, request.path, request.overrides);
  const system::Machine& m = deck.machine;
  const std::string rotor =
      m.rotor.segments.empty() ? "rigid rotor" : count(m.rotor.segments.size(), "segment", "segments");
  const std::string what = system::is_rotor(m)
                               ? rotor + ", " + count(m.bearings.size(), "bearing", "bearings") +
                                     (m.elements.empty() ? "" : ", " + count(m.elements.size(), "element", "elements"))
                               : "system " + m.system.name;
  std::string text =
      fmt::format("{}: no errors; {}, {}\n", request.path, what, count(deck.studies.size(), "study", "studies"));
  constexpr double notable = 2e8;
  for (const auto& s : deck.studies) {
    const auto* sweep = dynamic_cast<const study::Sweep*>(s.get());
    const double bytes = s->memory(m, layout_of(deck));
    text += fmt::format("  {} ({}{}){}\n", s->name(), s->kind(),
                        sweep ? ", " + count(sweep->variants().size(), "variant", "variants") : "",
                        bytes < notable ? "" : fmt::format(", about {} of memory", deck::write_memory(bytes)));
  }
  text += changes_text(deck.changes);
  return text + warnings_text(deck);
}

}  // namespace

void check(MPI_Comm comm, const CheckRequest& request, const Print& print) {
  std::string problems;
  for (const std::string& path : request.paths) {
    try {
      print(checked(comm, {path, request.overrides}));
    } catch (const core::InputError& e) {
      if (request.paths.size() == 1) throw;
      problems += fmt::format("{}{}", problems.empty() ? "" : "\n", e.what());
    }
  }
  if (!problems.empty()) refuse(problems);
}

std::string list() {
  std::string text;
  for (const auto& k : study::kinds()) text += fmt::format("{:<20} {}\n", k.name, k.text);
  return text;
}

std::string describe(const std::string& key) {
  try {
    return deck::reference_text(deck::structure_of<study::Deck>(), key, study::citations());
  } catch (core::InputError& e) {
    e.mark_agreed();
    throw;
  }
}

std::string schema() {
  return deck::schema_text(deck::structure_of<study::Deck>(), "Input deck of Whirl");
}

}  // namespace whirl::app
