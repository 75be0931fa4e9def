// What a checkpoint keeps of work that is under way.

#include <gtest/gtest.h>
#include <mpi.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include "study/pieces.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::study {
namespace {

namespace fs = std::filesystem;

struct Kill : std::runtime_error {
  Kill() : std::runtime_error("killed") {}
};

// One run after another on one checkpoint.
class Interrupted : public testing::Test {
protected:
  Interrupted() {
    int process = getpid();
    MPI_Bcast(&process, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    path_ = fs::temp_directory_path() / ("whirl_pieces_" + std::to_string(process) + ".h5");
  }
  ~Interrupted() override { remove(); }
  Pieces& begin(bool resume, int layout = 1) {
    pieces_.reset();
    findings_.emplace(PETSC_COMM_WORLD, "study", "test", path_, Findings::Say{});
    return pieces_.emplace(*findings_, resume, true, layout);
  }
  double ask(Pieces& pieces, const char* kind, double value) {
    const auto answer = pieces.replay_log()->ask(kind, {}, [&](const auto&) {
      ++works_;
      return solve::ReplayLog::Answer{{value}, {}};
    });
    return answer.numbers.front();
  }
  /// As if the program that wrote the checkpoint had been an older one.
  void age() {
    io::Group all = findings_->load_checkpoint();
    all.set("format", 1);
    findings_->save_checkpoint(all);
  }
  int works_ = 0;

  void remove() const {
    if (core::rank_of(PETSC_COMM_WORLD) == 0)
      for (const char* end : {"", ".prev", ".next"}) fs::remove(path_.string() + end);
    MPI_Barrier(PETSC_COMM_WORLD);
  }

private:
  fs::path path_;
  std::optional<Findings> findings_;
  std::optional<Pieces> pieces_;
};

TEST_F(Interrupted, APieceUnderWayGoesOnFromItsParts) {
  Pieces& first = begin(false);
  const auto part_then_kill = [&]() -> double {
    (void)ask(first, "part", 2);  // saved at once
    throw Kill();
  };
  EXPECT_THROW((void)first.number("whole", part_then_kill), Kill);
  Pieces& second = begin(true);
  EXPECT_FALSE(second.known("whole"));
  EXPECT_EQ(second.number("whole", [&] { return 3 * ask(second, "part", 5); }), 6);
  EXPECT_EQ(works_, 1);
  EXPECT_TRUE(second.replay_log()->entries().empty()) << "parts of what is known are of no use";
}

TEST_F(Interrupted, AnotherOrderOfUnknownsLeavesTheReplayLog) {
  (void)ask(begin(false, 1), "part", 2);
  Pieces& other = begin(true, 2);
  EXPECT_FALSE(other.same_layout());
  EXPECT_EQ(ask(other, "part", 3), 3);
}

// Vectors that ranks share are written by rows, others as a whole; each comes back in whatever layout.
TEST_F(Interrupted, AReplayLogOfAnotherVersionIsRefused) {
  (void)ask(begin(false), "part", 2);
  (void)begin(true);
  age();
  EXPECT_THROW((void)begin(true), core::InputError);
}

TEST_F(Interrupted, AnswersKeepTheirVectors) {
  const int rank = core::rank_of(PETSC_COMM_WORLD);
  const auto numbered = [](PetscInt local) {
    core::Vector v = core::make_vector(PETSC_COMM_WORLD, local, PETSC_DETERMINE);
    PetscInt begin = 0;
    core::check(VecGetOwnershipRange(v.get(), &begin, nullptr));
    const core::WriteArray a(v.get());
    for (PetscInt i = 0; i < a.size(); ++i) a[i] = 0.5 * static_cast<double>(begin + i + 1);
    return v;
  };
  const core::Vector kept = numbered(rank + 1), short_one = numbered(1);
  for (const bool by_rows : {false, true}) {
    using solve::ReplayLog;
    Pieces& first = begin(false);
    first.replay_log()->by_rows = by_rows ? core::size_of(PETSC_COMM_WORLD) : 0;
    const auto answer = [&](const ReplayLog* replay_log) {
      return ReplayLog::Answer{
          {3, 4}, "found", {ReplayLog::keep(replay_log, kept.get()), ReplayLog::keep(replay_log, short_one.get())}};
    };
    (void)first.replay_log()->ask("one", {1}, [&](const auto&) {
      return ReplayLog::Answer{{}, {}, answer(first.replay_log()).vectors};
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    (void)first.replay_log()->ask("two", {2}, [&](const auto&) { return answer(first.replay_log()); });
    Pieces& second = begin(true);
    const auto never = [](const auto&) -> ReplayLog::Answer { throw Kill(); };
    (void)second.replay_log()->ask("one", {1}, never);
    const ReplayLog::Answer found = second.replay_log()->ask("two", {2}, never);
    EXPECT_EQ(found.numbers, (std::vector<double>{3, 4}));
    EXPECT_EQ(found.text, "found");
    ASSERT_EQ(found.vectors.size(), 2U);
    EXPECT_EQ(found.vectors[0].whole, !by_rows);
    core::Vector back = core::duplicate(kept.get());
    ReplayLog::give(found.vectors[0], back.get());
    core::check(VecAXPY(back.get(), -1, kept.get()));
    EXPECT_EQ(core::norm(back.get()), 0) << by_rows;
    EXPECT_GT(core::norm(kept.get()), 0);
    EXPECT_THROW(ReplayLog::give(found.vectors[0], core::make_vector(PETSC_COMM_WORLD, 7, PETSC_DETERMINE).get()),
                 core::Error);
    remove();
  }
}

// A state takes the place of what was found since the last one, which was more than has been repeated so far.
TEST_F(Interrupted, NoStateIsSavedBeforeAllIsRepeated) {
  Pieces& first = begin(false);
  io::Group state;
  state.set("place", 1);
  first.save(std::move(state));
  (void)ask(first, "before", 2);
  std::this_thread::sleep_for(std::chrono::milliseconds(600));
  (void)ask(first, "behind", 3);  // saved with the one before
  Pieces& second = begin(true);
  EXPECT_EQ(second.state().integer("place"), 1);
  EXPECT_EQ(ask(second, "before", 0), 2);
  EXPECT_FALSE(second.state_due());
  EXPECT_EQ(ask(second, "behind", 0), 3);
  EXPECT_TRUE(second.state_due());
}

}  // namespace
}  // namespace whirl::study
