#include "whirl/io/checkpoint.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

#include "io/temporary.hpp"
#include "whirl/core/error.hpp"
#include "whirl/io/hdf5.hpp"

using namespace whirl;
using namespace whirl::io;

namespace {

Group state(int step) {
  Group g;
  g.set("step", step);
  g.put("x", std::vector<double>(2000, step), "1", "state");
  return g;
}

// Overwrites some bytes in the middle of the stored numbers.
void damage(const std::filesystem::path& path) {
  std::fstream f(path, std::ios::in | std::ios::out | std::ios::binary);
  f.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path) - 4000));
  f << "damaged!";
}

}  // namespace

TEST(Checkpoint, GivesBackTheNewest) {
  const test::Temporary folder;
  const Checkpoint c(folder / "branch.h5");
  EXPECT_FALSE(c.exists());
  c.save(state(1));
  c.save(state(2));
  const Checkpoint::Loaded l = c.load();
  EXPECT_EQ(l.state, state(2));
  EXPECT_FALSE(l.from_previous);
  // What a kill leaves of one that was not finished.
  for (const char* left : {"branch.h5.next", "branch.h5.next.part"}) std::ofstream(folder / left) << "half";
  c.remove();
  EXPECT_FALSE(c.exists());
  EXPECT_TRUE(std::filesystem::is_empty(folder / "."));
}

TEST(Checkpoint, ADamagedOneFallsBackToItsPredecessor) {
  const test::Temporary folder;
  const Checkpoint c(folder / "branch.h5");
  c.save(state(1));
  c.save(state(2));
  damage(folder / "branch.h5");
  const Checkpoint::Loaded l = c.load();
  EXPECT_EQ(l.state, state(1));
  EXPECT_TRUE(l.from_previous);
  EXPECT_NE(l.reason.find("damaged"), std::string::npos) << l.reason;

  std::filesystem::resize_file(folder / "branch.h5", 700);  // cut off
  EXPECT_EQ(c.load().state, state(1));
  std::filesystem::remove(folder / "branch.h5");  // killed between the two renames
  EXPECT_TRUE(c.exists());
  EXPECT_EQ(c.load().state, state(1));

  damage(folder / "branch.h5.prev");
  try {
    (void)c.load();
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("branch.h5.prev"), std::string::npos) << e.what();
  }
}

TEST(Checkpoint, AnotherFileIsNoCheckpoint) {
  const test::Temporary folder;
  write_hdf5(folder / "results.h5", state(1));
  EXPECT_THROW((void)Checkpoint(folder / "results.h5").load(), core::Error);
}

// A child writes one checkpoint after the other and is killed at varying moments; what is left always is readable and
// not older than the one before the last that the child reported.
TEST(Checkpoint, SurvivesAKillAtAnyMoment) {
  const test::Temporary folder;
  const Checkpoint c(folder / "branch.h5");
  for (int trial = 0; trial < 20; ++trial) {
    c.remove();
    int pipe_ends[2];
    ASSERT_EQ(::pipe(pipe_ends), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (int step = 1;; ++step) {
        c.save(state(step));
        if (::write(pipe_ends[1], &step, sizeof step) < 0) ::_exit(1);
      }
    }
    ::close(pipe_ends[1]);
    int reported = 0;
    ASSERT_EQ(::read(pipe_ends[0], &reported, sizeof reported), static_cast<ssize_t>(sizeof reported));
    ::usleep(static_cast<useconds_t>(200 + 331 * trial));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    for (int step = 0; ::read(pipe_ends[0], &step, sizeof step) == static_cast<ssize_t>(sizeof step);) reported = step;
    ::close(pipe_ends[0]);
    const Group left = c.load().state;
    const auto step = static_cast<int>(left.integer("step"));
    EXPECT_GE(step, reported);
    EXPECT_LE(step, reported + 1);
    EXPECT_EQ(left, state(step));
  }
}

TEST(Checkpoint, TimeOfOneSave) {
  const test::Temporary folder;
  const Checkpoint c(folder / "branch.h5");
  Group g;
  g.put("states", {121, 104}, std::vector<double>(121 * 104, 1.5), "1", "cycle");
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < 10; ++i) c.save(g);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  RecordProperty("milliseconds_per_save", std::to_string(elapsed.count() * 100));
  EXPECT_EQ(c.load().state, g);
}
