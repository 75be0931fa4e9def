#pragma once
// What each command does; texts are returned for main to print.

#include <mpi.h>

#include <string>
#include <vector>

#include "whirl/core/error.hpp"

namespace whirl::app {

struct DeckRequest {
  std::string path;
  std::vector<std::string> overrides;
};
struct RunRequest {
  DeckRequest deck;
  std::string directory;
  bool resume = false;
  bool force = false;
  bool progress = false;
};

/// Computes a deck; `text` is what to tell the user at the end. Collective. Nothing is written if the deck is wrong.
[[nodiscard]] core::Exit run(MPI_Comm comm, const RunRequest& request, std::string& text);
[[nodiscard]] std::string check(MPI_Comm comm, const DeckRequest& request);
[[nodiscard]] std::string list();
[[nodiscard]] std::string describe(const std::string& key);
[[nodiscard]] std::string schema();

}  // namespace whirl::app
