#pragma once
// Runs a loaded deck in a directory of its own and returns what it wrote.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "whirl/core/petsc.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/study/deck.hpp"

namespace whirl::test {

/// The studies' summaries, as a user reads them; `name` is that of the temporary directory. Collective on the world.
inline std::vector<io::StudySummary> run_deck(study::Deck& deck, const std::string& name) {
  const std::filesystem::path directory = std::filesystem::temp_directory_path() / ("whirl_" + name);
  if (core::rank_of(MPI_COMM_WORLD) == 0) {
    std::filesystem::remove_all(directory);
    std::filesystem::create_directories(directory);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_TRUE(study::run(MPI_COMM_WORLD, deck, {directory.string(), "test", {}, {}, false}).empty());
  MPI_Barrier(MPI_COMM_WORLD);
  auto studies = io::Summary::read(directory / "summary.json").studies;
  MPI_Barrier(MPI_COMM_WORLD);
  if (core::rank_of(MPI_COMM_WORLD) == 0) std::filesystem::remove_all(directory);
  return studies;
}

inline std::map<std::string, double> values_of(const io::StudySummary& s) {
  std::map<std::string, double> values;
  for (const auto& [name, q] : s.values) {
    values[name] = q.value;
    for (const auto& [part, bar] : q.more) values[name + "." + part] = bar;
  }
  return values;
}

}  // namespace whirl::test
