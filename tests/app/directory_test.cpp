// The directory of results as an object: what it holds while it lives, what it gives back, what a killed one left.

#include "app/directory.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <vector>

#include "io/temporary.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/io/manifest.hpp"

namespace {

using namespace whirl;
using app::Directory;
using app::Earlier;
namespace fs = std::filesystem;

void make(const fs::path& path, const std::string& text = "x") {
  fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

std::string text(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> left(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& e : fs::recursive_directory_iterator(folder))
    names.push_back(fs::relative(e.path(), folder).string());
  std::sort(names.begin(), names.end());
  return names;
}

// A directory with results of the deck "old".
void run_once(const fs::path& folder) {
  const Directory held(MPI_COMM_SELF, folder.string(), "old", Earlier::refuse);
  for (const char* name : {"results.h5", "summary.json", "csv/s/t.csv"}) {
    io::Manifest(folder).add(name);
    make(folder / name);
  }
}

}  // namespace

// A folder that was refused is free again: by another program, and by this one.
TEST(Directory, ARefusalHoldsNoLock) {
  const test::Temporary folder;
  const std::string path = (folder / "run").string();
  make(folder / "run/thesis.txt");
  EXPECT_THROW(Directory(MPI_COMM_SELF, path, "deck", Earlier::refuse), core::InputError);
  fs::remove(folder / "run/thesis.txt");
  const Directory held(MPI_COMM_SELF, path, "deck", Earlier::refuse);
  EXPECT_TRUE(held.locked());
  EXPECT_THROW(Directory(MPI_COMM_SELF, path, "deck", Earlier::refuse), core::InputError) << "it is held";
}

TEST(Directory, WhatIsAbandonedIsAsItWasBefore) {
  const test::Temporary folder;
  {
    Directory held(MPI_COMM_SELF, (folder / "new/run").string(), "wrong", Earlier::refuse);
    held.abandon();
    EXPECT_FALSE(fs::exists(folder / "new/run"));
  }
  fs::create_directories(folder / "empty");
  {
    Directory held(MPI_COMM_SELF, (folder / "empty").string(), "wrong", Earlier::refuse);
    held.abandon();
    EXPECT_EQ(left(folder / "empty"), std::vector<std::string>{});
  }
  // Results that a study has written by then stay, with their deck.
  Directory held(MPI_COMM_SELF, (folder / "run").string(), "half wrong", Earlier::refuse);
  io::Manifest(folder / "run").add("results.h5");
  make(folder / "run/results.h5");
  held.abandon();
  EXPECT_EQ(left(folder / "run"), (std::vector<std::string>{"manifest.txt", "resolved.yaml", "results.h5"}));
}

// Each state that a kill during --force can leave: the next run needs no --force, and finds nothing of the old one.
TEST(Directory, AKilledReplacementIsFinishedByTheNextRun) {
  for (const int removed : {0, 1, 2, 3, 4})
    for (const Earlier next : {Earlier::refuse, Earlier::resume, Earlier::replace}) {
      const test::Temporary folder;
      const fs::path run = folder / "run";
      run_once(run);
      make(run / "mine.png");
      make(run / "resolved.yaml.removing", "new");
      const char* order[] = {"results.h5", "summary.json", "csv/s/t.csv", "manifest.txt"};
      for (int k = 0; k < removed; ++k) fs::remove(run / order[k]);
      const Directory held(MPI_COMM_SELF, run.string(), "third", next);
      EXPECT_EQ(text(run / "resolved.yaml"), "third");
      const auto files = left(run);
      EXPECT_EQ(std::count(files.begin(), files.end(), "results.h5"), 0);
      EXPECT_EQ(std::count(files.begin(), files.end(), "summary.json"), 0);
      EXPECT_EQ(std::count(files.begin(), files.end(), "resolved.yaml.removing"), 0);
      EXPECT_EQ(std::count(files.begin(), files.end(), "mine.png"), 1);
    }
}

// Killed before anything was removed, --force has cost nothing: the next run asks again.
TEST(Directory, AReplacementKilledBeforeItBeganIsForgotten) {
  const test::Temporary folder;
  const fs::path run = folder / "run";
  run_once(run);
  const auto before = left(run);
  make(run / "resolved.yaml.next", "new");
  EXPECT_THROW(Directory(MPI_COMM_SELF, run.string(), "third", Earlier::refuse), core::InputError);
  EXPECT_EQ(left(run), before);
}

// Between two renames a kill leaves of a checkpoint only the one before: work that a plain run must not throw away.
TEST(Directory, ACheckpointLeftAsPreviousIsAResult) {
  const test::Temporary folder;
  const fs::path run = folder / "run";
  {
    const Directory held(MPI_COMM_SELF, run.string(), "deck", Earlier::refuse);
    io::Manifest(run).add("branch.checkpoint.h5");
    make(run / "branch.checkpoint.h5.prev");
  }
  EXPECT_THROW(Directory(MPI_COMM_SELF, run.string(), "deck", Earlier::refuse), core::InputError);
  { const Directory held(MPI_COMM_SELF, run.string(), "deck", Earlier::resume); }
  EXPECT_TRUE(fs::exists(run / "branch.checkpoint.h5.prev"));
  const Directory held(MPI_COMM_SELF, run.string(), "deck", Earlier::replace);
  EXPECT_FALSE(fs::exists(run / "branch.checkpoint.h5.prev"));
}

// A disk that is full before anything was removed: the earlier results are as they were, and still need --force.
TEST(Directory, AFullDiskReplacesNothing) {
  const test::Temporary folder;
  const fs::path run = folder / "run";
  run_once(run);
  const auto before = left(run);
  auto* const at_limit = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit none{0, limit.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &none), 0);
  EXPECT_THROW(Directory(MPI_COMM_SELF, run.string(), "new", Earlier::replace), core::Error);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  (void)std::signal(SIGXFSZ, at_limit);
  EXPECT_EQ(left(run), before);
  EXPECT_THROW(Directory(MPI_COMM_SELF, run.string(), "new", Earlier::refuse), core::InputError);
}

TEST(Directory, ReplacesResultsOnlyWhenAsked) {
  const test::Temporary folder;
  const fs::path run = folder / "run";
  run_once(run);
  EXPECT_THROW(Directory(MPI_COMM_SELF, run.string(), "new", Earlier::refuse), core::InputError);
  EXPECT_THROW(Directory(MPI_COMM_SELF, run.string(), "new", Earlier::resume), core::InputError);
  EXPECT_EQ(text(run / "resolved.yaml"), "old");
  EXPECT_EQ(left(run).size(), 7U);
  const Directory held(MPI_COMM_SELF, run.string(), "new", Earlier::replace);
  EXPECT_EQ(left(run), (std::vector<std::string>{"manifest.txt", "resolved.yaml"}));
  EXPECT_EQ(text(run / "resolved.yaml"), "new");
}
