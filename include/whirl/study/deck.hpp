#pragma once
// A whole deck: the machine and what is asked about it.

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "whirl/deck/edit.hpp"
#include "whirl/deck/output.hpp"
#include "whirl/study/layout_options.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

/// What a run may take.
struct Limits {
  double memory = 8e9;  ///< in all ranks together [byte]
};
void describe(deck::Description<Limits>& d);

struct Deck {
  Deck();  ///< the machine finds where it rests by the solvers of studies
  system::Machine machine;
  Limits limits;
  LayoutOptions layout;
  BarsFrom bars = BarsFrom::meshes;
  std::vector<std::unique_ptr<Study>> studies;
  std::vector<deck::Change> changes;  ///< what the overrides did
};
void describe(deck::Description<Deck>& d);
/// What studies are given of the layout: with the deck's `bars`.
[[nodiscard]] LayoutOptions layout_of(const Deck& deck);

/// Reads and checks the deck at `path` after `overrides` (arguments of `--set`); nothing is solved. Collective; the
/// same on all ranks. Throws core::InputError (agreed) with a line per problem.
[[nodiscard]] Deck load(MPI_Comm comm, const std::string& path, const std::vector<std::string>& overrides);

/// Full references of the sources that help names in short.
[[nodiscard]] std::span<const deck::Citation> citations();

/// What is unusual about the numbers of the machine and about its error bars, a line each; the results carry these.
[[nodiscard]] std::vector<std::string> unusual(const system::Machine& machine, BarsFrom bars);
/// That, and what is unusual about tables beside the speeds of studies and about variants, a line each; nothing of it
/// keeps the deck from being computed.
[[nodiscard]] std::vector<std::string> warnings(const Deck& deck);

/// The deck as understood: valid, SI, every default written out.
[[nodiscard]] std::string resolved_text(const Deck& deck);

/// How a run is wanted.
struct RunOptions {
  std::string directory;  ///< of the results; exists
  std::string version;
  /// Shows a progress line on rank 0 (`transient` lines replace each other); empty: silent.
  std::function<void(const std::string& line, bool transient)> say;
  /// Called on rank 0 as soon as the results of a study are written, and first for those that an earlier run finished.
  std::function<void(const io::StudySummary& study)> ended;
  bool resume = false;
};

/// Runs all studies in turn and leaves their results in the directory; returns `NAME: reason` for each one that could
/// deliver nothing. Collective.
[[nodiscard]] std::vector<std::string> run(MPI_Comm comm, const Deck& deck, const RunOptions& options);

}  // namespace whirl::study
