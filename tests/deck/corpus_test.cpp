// The fuzzer's corpus, with what it found: none may crash, and what is written must read back.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "fuzz/target.hpp"
#include "source_dir.hpp"

TEST(Corpus, IsReadOrRefused) {
  int n = 0;
  for (const auto& e : std::filesystem::directory_iterator(WHIRL_SOURCE_DIR "/tests/fuzz/corpus")) {
    std::ifstream in(e.path(), std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    SCOPED_TRACE(e.path().filename().string());
    EXPECT_NO_THROW(whirl::fuzz::try_deck(bytes.str()));
    ++n;
  }
  EXPECT_GE(n, 10);
}
