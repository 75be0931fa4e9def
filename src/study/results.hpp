#pragma once
// Where studies put what they found: results.h5, summary.json, checkpoints, progress.

#include <mpi.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "whirl/io/checkpoint.hpp"
#include "whirl/io/manifest.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Results of one run. Every rank holds the same tree; rank 0 of `comm` writes the files.
class Results {
public:
  using Say = std::function<void(const std::string& line, bool transient)>;

  /// `say` shows progress (called on rank 0 only, may be empty); `resume` takes over what an earlier run left in the
  /// directory.
  Results(MPI_Comm comm, std::filesystem::path directory, const std::string& title, const std::string& version, Say say,
          bool resume);

  /// True if an earlier run finished this study and it delivered something; its results are kept.
  [[nodiscard]] bool finished(const std::string& name) const;
  /// Starts a study: clears its group and summary.
  void begin(const std::string& name, const std::string& kind);
  /// Ends it with its status and writes the files.
  void finish(const std::string& status, bool delivered);

  /// The group of a study that is finished.
  [[nodiscard]] const io::Group& group_of(const std::string& name) const;
  /// The group and the summary of the study that runs.
  [[nodiscard]] io::Group& group();
  [[nodiscard]] io::StudySummary& summary() { return current_; }
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count() + earlier_seconds_;
  }
  void add_earlier_seconds(double seconds) { earlier_seconds_ += seconds; }

  /// Replaces the progress line; rank 0 only, at most ten times a second.
  void progress(const std::string& line);
  [[nodiscard]] bool shows_progress() const { return static_cast<bool>(say_); }

  /// Checkpoint of the study that runs: saved on rank 0, loaded on all ranks (empty group if there is none).
  void save_checkpoint(const io::Group& state);
  [[nodiscard]] io::Group load_checkpoint() const;
  [[nodiscard]] bool has_checkpoint() const;

  /// `NAME: reason` for each study that delivered nothing.
  [[nodiscard]] const std::vector<std::string>& undelivered() const { return undelivered_; }
  /// Where a file of the results goes; its name enters the manifest. Call on rank 0.
  [[nodiscard]] std::filesystem::path file(const std::string& name);
  [[nodiscard]] io::Group& root() { return root_; }
  [[nodiscard]] std::string group_path() const { return "/studies/" + io::safe_name(current_.name); }

private:
  void write();
  [[nodiscard]] io::Checkpoint checkpoint(const std::string& study) const;

  MPI_Comm comm_;
  int rank_;
  std::filesystem::path directory_;
  io::Manifest manifest_;  // rank 0's is the one that grows
  Say say_;
  io::Group root_;
  io::Summary all_;
  io::StudySummary current_;
  std::vector<std::string> finished_;
  std::chrono::steady_clock::time_point started_run_, started_, last_line_;
  double earlier_seconds_ = 0, earlier_run_seconds_ = 0;
  std::vector<std::string> undelivered_;
};

}  // namespace whirl::study
