// Every deck, and every deck as we write it, holds the same numbers and texts for readers of YAML 1.1 (PyYAML).

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "source_dir.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/study/deck.hpp"

using namespace whirl;
namespace fs = std::filesystem;

TEST(YamlTypes, DecksAndResolvedDecksAreReadAlike) {
  if (core::rank_of(MPI_COMM_WORLD) > 0) return;
  const fs::path root(WHIRL_SOURCE_DIR),
      folder = fs::temp_directory_path() / ("whirl_types_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::string command = "python3 '" + (root / "tests/app/yaml_types.py").string() + "'";
  int n = 0;
  for (const auto& e : fs::recursive_directory_iterator(root / "inputs")) {
    if (e.path().extension() != ".yaml") continue;
    const fs::path resolved = folder / (std::to_string(++n) + "_" + e.path().filename().string());
    std::ofstream(resolved) << study::resolved_text(study::load(MPI_COMM_SELF, e.path().string(), {}));
    command += " '" + e.path().string() + "' '" + resolved.string() + "'";
  }
  EXPECT_GE(n, 30);
  EXPECT_EQ(std::system(command.c_str()), 0);
  fs::remove_all(folder);
}
