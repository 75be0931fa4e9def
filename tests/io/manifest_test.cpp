// Which files belong to a run: nothing else is removed, whatever the manifest says.

#include "whirl/io/manifest.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "temporary.hpp"
#include "whirl/core/error.hpp"
#include "whirl/io/record.hpp"

namespace {

using whirl::io::Manifest;
namespace fs = std::filesystem;

void make(const fs::path& path) {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << "x";
}

std::string text(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST(Manifest, NamesEachFileOnceAndReadsThemBack) {
  const whirl::test::Temporary folder;
  Manifest m(folder.path());
  EXPECT_FALSE(m.exists());
  m.add("a.h5");
  m.add("csv/b/branch.csv");
  m.add("a.h5");
  EXPECT_EQ(text(folder / "manifest.txt"), "a.h5\ncsv/b/branch.csv\n");
  EXPECT_EQ(Manifest(folder.path()).names(), (std::vector<std::string>{"a.h5", "csv/b/branch.csv"}));
}

TEST(Manifest, RemovesWhatItNamesAndWhatAKillLeftOfThat) {
  const whirl::test::Temporary folder;
  for (const char* name : {"a.h5", "b.checkpoint.h5.prev", "b.checkpoint.h5.next.part", "csv/s/t.csv", "csv/own.csv",
                           "mine.png", "mine.part"})
    make(folder / name);
  Manifest m(folder.path());
  for (const char* name : {"a.h5", "b.checkpoint.h5", "csv/s/t.csv", "gone.h5", "kept.yaml"}) m.add(name);
  make(folder / "kept.yaml");
  m.remove_files("kept.yaml");
  std::vector<std::string> left;
  for (const auto& e : fs::recursive_directory_iterator(folder.path()))
    left.push_back(fs::relative(e.path(), folder.path()).string());
  std::sort(left.begin(), left.end());
  EXPECT_EQ(left, (std::vector<std::string>{"csv", "csv/own.csv", "kept.yaml", "mine.part", "mine.png"}));
}

TEST(Manifest, LeadsNowhereElse) {
  const whirl::test::Temporary folder;
  make(folder / "run/x");
  make(folder / "thesis.txt");
  make(folder / "run/half");
  // Written by hand, or cut short by a kill: the last line has no end.
  std::ofstream(folder / "run/manifest.txt") << "../thesis.txt\n"
                                             << (folder / "thesis.txt").string() << "\n\n.\nx\r\nhal";
  Manifest m(folder / "run");
  EXPECT_EQ(m.names(), std::vector<std::string>{"x"});
  m.add("f");
  EXPECT_EQ(Manifest(folder / "run").names(), (std::vector<std::string>{"x", "f"}));
  EXPECT_THROW(m.add("../thesis.txt"), whirl::core::Error);
  EXPECT_THROW(m.add("a\nb"), whirl::core::Error);
  m.remove_files();
  EXPECT_TRUE(fs::exists(folder / "thesis.txt"));
  EXPECT_TRUE(fs::exists(folder / "run/half"));
  EXPECT_FALSE(fs::exists(folder / "run/x"));
}

TEST(Manifest, RemovesNothingBehindALink) {
  const whirl::test::Temporary folder;
  make(folder / "elsewhere/s/t.csv");
  fs::create_directories(folder / "run/csv");
  fs::create_directory_symlink(folder / "elsewhere", folder / "run/pictures");
  fs::create_symlink(folder / "elsewhere/s/t.csv", folder / "run/csv/u.csv");
  Manifest m(folder / "run");
  for (const char* name : {"pictures/s/t.csv", "csv/u.csv"}) m.add(name);
  m.remove_files();
  EXPECT_TRUE(fs::exists(folder / "elsewhere/s/t.csv"));
  EXPECT_TRUE(fs::is_symlink(folder / "run/pictures"));
  EXPECT_FALSE(fs::is_symlink(folder / "run/csv/u.csv")) << "a link of that name is itself a file of the run";
}

TEST(Record, NamesOfFilesAreThoseOfThePictures) {
  using whirl::io::plain_name;
  EXPECT_EQ(plain_name("a b"), "a_b");
  EXPECT_EQ(plain_name("a_ /b"), "a_b");
  EXPECT_EQ(plain_name("G2.5 flip 1"), "G2.5_flip_1");
  EXPECT_EQ(plain_name("../x."), "x");
  EXPECT_EQ(plain_name("Gr\xc3\xb6\xc3\x9f"
                       "e"),
            "Gr_e");
  EXPECT_EQ(plain_name("/"), "study");
}
