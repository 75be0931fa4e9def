#pragma once
// The files of a run: results.h5 and summary.json, and what an earlier run left in them.

#include <mpi.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "run_studies.hpp"
#include "whirl/io/manifest.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Writes the results of one study after another. Every rank holds the same tree but for the rows of fields that ranks
/// share; all ranks of `comm` write these, and rank 0 all else.
class Writer final : public Store {
public:
  /// To resume takes over what an earlier run left in the directory.
  Writer(MPI_Comm comm, const Deck& deck, const RunOptions& options);

  [[nodiscard]] bool finished(const std::string& name) const override;
  /// The manifest names it from now on.
  [[nodiscard]] std::filesystem::path checkpoint_path(const std::string& study) override;
  /// Writes the files as well.
  void add(StudyResult result) override;
  /// After the last study: removes checkpoints of parts of studies that a kill between result and removal left.
  void end();
  [[nodiscard]] const io::Group& studies() const override { return root_.group("studies"); }
  [[nodiscard]] std::span<const io::StudySummary> summaries() const override { return all_.studies; }
  /// `NAME: reason` for each study that delivered nothing.
  [[nodiscard]] const std::vector<std::string>& undelivered() const { return undelivered_; }

private:
  void write();
  // Tells rank 0's user of a study that is written.
  void tell(const std::string& name) const;
  // Where a file goes; rank 0 enters its name into the manifest.
  [[nodiscard]] std::filesystem::path file(const std::string& name);

  MPI_Comm comm_;
  int rank_;
  std::filesystem::path directory_;
  io::Manifest manifest_;  // rank 0's is the one that grows
  io::Group root_;
  io::Summary all_;
  std::vector<std::string> finished_;
  std::chrono::steady_clock::time_point started_;
  double earlier_seconds_ = 0;
  std::vector<std::string> undelivered_;
  std::function<void(const io::StudySummary&)> ended_;
  std::optional<deck::Quantity> service_speed_;
  bool films_;
};

}  // namespace whirl::study
