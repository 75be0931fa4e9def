#pragma once
// What one run of a study has found so far, its clock, its progress line and its checkpoint.

#include <mpi.h>

#include <array>
#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/io/xdmf.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

/// The result that a study works on; it knows no file but its checkpoint. Every rank holds the same.
class Findings {
public:
  using Say = std::function<void(const std::string& line, bool transient)>;

  /// Of the study `name` of that kind; `say` shows progress (called on rank 0 only, may be empty).
  Findings(MPI_Comm comm, const std::string& name, const std::string& kind, std::filesystem::path checkpoint, Say say);

  /// Tables and fields.
  [[nodiscard]] io::Group& group() { return result_.group; }
  [[nodiscard]] io::StudySummary& summary() { return result_.summary; }
  /// Another checkpoint that goes as soon as the result is written.
  void leave_behind(std::filesystem::path checkpoint) { result_.checkpoints.push_back(std::move(checkpoint)); }
  /// Shows a mesh in ParaView; dataset paths are relative to group().
  void show(io::StructuredGrid grid) { result_.grids.push_back(std::move(grid)); }
  /// The result, with how it ended; nothing may be added any more.
  [[nodiscard]] StudyResult finish(const std::string& status, bool delivered);

  /// Wall time of this study, that of the run it resumes included.
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count() + earlier_seconds_;
  }
  void add_earlier_seconds(double seconds) { earlier_seconds_ += seconds; }

  /// Replaces the progress line; rank 0 only, at most ten times a second.
  void progress(const std::string& line);
  [[nodiscard]] bool shows_progress() const { return static_cast<bool>(say_); }
  /// ", 3 min left" at the pace of the last half minute, if the share `done` [1] of this study is done; for its
  /// progress line. Empty before the pace is known, and without progress.
  [[nodiscard]] std::string left(double done);
  /// The same where a study runs over a parameter: ", 42 % of 1000 to 6000 rpm, 3 min left".
  [[nodiscard]] std::string left_over(double at, double from, double to, const std::string& unit);
  /// The same at once, for the progress of a part of this study.
  void say(const std::string& line, bool transient) const {
    if (say_) say_(line, transient);
  }

  /// Rank 0's word, for all: what a clock decides must be decided alike. Collective.
  [[nodiscard]] bool agreed(bool word) const;

  /// Saves what `state` makes, with the time taken so far, unless that was done within the last second. Collective.
  void save_each_second(const std::function<io::Group()>& state);
  /// Saved by rank 0, and by all ranks where they share datasets; loaded on all ranks, which then have as many rows of
  /// these as each other. Collective.
  void save_checkpoint(const io::Group& state) const;
  [[nodiscard]] io::Group load_checkpoint() const;
  [[nodiscard]] bool has_checkpoint() const;

  /// Communicators of `count` groups of as many neighbouring ranks each: this rank's group, and the ranks that have its
  /// place in the others. They live as long as this. Collective.
  struct RankGroups {
    MPI_Comm space, time;
  };
  [[nodiscard]] RankGroups rank_groups(int count);

  ~Findings();
  Findings(const Findings&) = delete;
  Findings& operator=(const Findings&) = delete;

private:
  MPI_Comm comm_;
  std::map<int, RankGroups> rank_groups_;
  int rank_;
  std::filesystem::path checkpoint_;
  Say say_;
  StudyResult result_;
  std::chrono::steady_clock::time_point started_, last_line_;
  double earlier_seconds_ = 0, last_saved_ = -1e9;
  std::deque<std::array<double, 2>> pace_;  // seconds and what was done by then, of the last half minute
};

/// "95 s", "12 min", "5 h", "3 days".
[[nodiscard]] std::string duration_in_words(double seconds);

}  // namespace whirl::study
