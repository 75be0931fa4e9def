#pragma once
// What each command does; texts are returned for main to print.

#include <mpi.h>

#include <functional>
#include <string>
#include <vector>

#include "whirl/core/error.hpp"

namespace whirl::app {

struct DeckRequest {
  std::string path;
  std::vector<std::string> overrides;
};
struct CheckRequest {
  std::vector<std::string> paths;  // one or more
  std::vector<std::string> overrides;
};
struct RunRequest {
  DeckRequest deck;
  std::string directory;
  bool resume = false;
  bool force = false;
  bool progress = false;
  int stop_after_checkpoint = 0;  ///< end as a killed run does; 0: never
};

/// Shows a text at once.
using Print = std::function<void(const std::string& text)>;
/// Computes a deck and tells of each study as soon as it ends. Collective. Nothing is written if the deck is wrong.
[[nodiscard]] core::Exit run(MPI_Comm comm, const RunRequest& request, const Print& print);
/// Checks decks one after another; a wrong one among several does not keep the others from being checked. Collective.
/// Throws core::InputError (agreed) with all problems of all of them.
void check(MPI_Comm comm, const CheckRequest& request, const Print& print);
[[nodiscard]] std::string list();
[[nodiscard]] std::string describe(const std::string& key);
[[nodiscard]] std::string schema();

}  // namespace whirl::app
