// Decks that must be refused with a stated message. The first lines of each say what is expected:
// `# expect: LINE:COLUMN: message` (or another place), `# set: PATH=VALUE` for overrides.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "source_dir.hpp"
#include "whirl/study/deck.hpp"

namespace {

using namespace whirl;
namespace fs = std::filesystem;

const std::string folder = std::string(WHIRL_SOURCE_DIR) + "/tests/failure";

struct Case {
  std::string expect;
  std::vector<std::string> overrides;
};

Case header_of(const fs::path& path) {
  const std::map<std::string, std::string> bare{{"empty", "1:1: the deck is empty"},
                                                {"binary", "1:1: the file is not UTF-8 text"},
                                                {"latin", "1:1: the file is not UTF-8 text"}};
  if (const auto it = bare.find(path.stem().string()); it != bare.end()) return {it->second, {}};
  Case c;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line) && line.starts_with("#");) {
    if (line.starts_with("# expect: ")) c.expect = line.substr(10);
    if (line.starts_with("# set: ")) c.overrides.push_back(line.substr(7));
  }
  return c;
}

std::string with_folder(std::string text) {
  if (const auto at = text.find("FOLDER"); at != std::string::npos) text.replace(at, 6, folder);
  return text;
}

}  // namespace

TEST(WrongDecks, AreRefusedWithTheStatedMessage) {
  int n = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    ++n;
    SCOPED_TRACE(entry.path().filename().string());
    const Case c = header_of(entry.path());
    ASSERT_FALSE(c.expect.empty());
    std::string expected = with_folder(c.expect);
    if (expected[0] >= '0' && expected[0] <= '9') expected = entry.path().string() + ":" + expected;
    if (expected.starts_with("base/")) expected = folder + "/" + expected;
    try {
      (void)study::load(MPI_COMM_WORLD, entry.path().string(), c.overrides);
      ADD_FAILURE() << "the deck was accepted";
    } catch (const core::InputError& e) {
      const std::string first = std::string(e.what()).substr(0, std::string(e.what()).find('\n'));
      if (expected.ends_with(": "))
        EXPECT_TRUE(first.starts_with(expected)) << first;
      else
        EXPECT_EQ(first, expected);
      EXPECT_EQ(e.exit(), core::Exit::input);
      EXPECT_TRUE(e.agreed());
    }
  }
  EXPECT_GE(n, 30);
}

TEST(WrongDecks, TheRigThatTheySpoilIsRight) {
  EXPECT_NO_THROW((void)study::load(MPI_COMM_WORLD, folder + "/base/rig.yaml", {}));
}

TEST(WrongDecks, LargeDecksAreRefused) {
  const fs::path path = fs::temp_directory_path() / "whirl_large_deck.yaml";
  {
    std::ofstream out(path);
    for (int i = 0; i < 40000; ++i) out << "# a line that says nothing at all\n";
  }
  EXPECT_THROW((void)study::load(MPI_COMM_WORLD, path.string(), {}), core::InputError);
}

TEST(WrongDecks, AllProblemsOfADeckAreToldAtOnce) {
  try {
    (void)study::load(MPI_COMM_WORLD, folder + "/base/rig.yaml",
                      {"gravity=9.81", "bearings.B1.node=0", "bearings.B2.geometry.clearance=1 s"});
    FAIL();
  } catch (const core::InputError& e) {
    const std::string all = e.what();
    EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 2) << all;
  }
}
