#pragma once
// A whole deck: the machine and what is asked about it.

#include <memory>
#include <string>
#include <vector>

#include "whirl/study/study.hpp"

namespace whirl::study {

struct Deck {
  system::Machine machine;
  std::vector<std::unique_ptr<Study>> studies;
};
void describe(deck::Description<Deck>& d);

/// Reads and checks the deck at `path` after `overrides` (`PATH=VALUE`); nothing is solved. Collective; the same on all
/// ranks. Throws core::InputError (agreed) with a line per problem.
[[nodiscard]] Deck load(MPI_Comm comm, const std::string& path, const std::vector<std::string>& overrides);

/// The deck as understood: valid, SI, every default written out.
[[nodiscard]] std::string resolved_text(const Deck& deck);

/// How a run is wanted.
struct RunOptions {
  std::string directory;  ///< of the results; exists
  bool progress = false;
  bool resume = false;
};

/// Runs all studies in turn and leaves their results in the directory; core::Exit::not_delivered if one of them could
/// deliver nothing. Collective.
[[nodiscard]] core::Exit run(MPI_Comm comm, const Deck& deck, const RunOptions& options);

}  // namespace whirl::study
