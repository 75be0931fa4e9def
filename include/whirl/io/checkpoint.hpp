#pragma once
// Checkpoints that survive a kill at any moment.

#include <mpi.h>

#include <array>
#include <filesystem>
#include <string>

#include "whirl/io/record.hpp"

namespace whirl::io {

/// A checkpoint file and its predecessor `<path>.prev`.
///
/// After a kill at any moment at least one of the two is complete. Without a communicator serial: call on one rank and
/// broadcast what matters.
class Checkpoint {
public:
  /// How the names of checkpoints end.
  static constexpr const char* ending = ".checkpoint.h5";
  /// What stands beside one while it is written, and what a kill leaves of it.
  static constexpr std::array<const char*, 3> beside{".prev", ".next", ".next.part"};

  explicit Checkpoint(std::filesystem::path path) : path_(std::move(path)) {}

  /// Writes `state` with its checksum, keeps the last checkpoint as `.prev`, then renames. Attributes of `state` whose
  /// name starts with "checkpoint_" are reserved.
  void save(const Group& state) const;
  /// The same by all ranks of `comm`, which share datasets of the state. Errors are agreed. Collective.
  void save(const Group& state, MPI_Comm comm) const;

  struct Loaded {
    Group state;
    bool from_previous = false;
    std::string reason;  ///< why the newest file was not used, if so
  };
  /// The newest readable state. core::Error naming both files and what is wrong with them if neither can be used.
  [[nodiscard]] Loaded load() const;
  /// The same on all ranks of `comm`: each has as many rows of shared datasets as the others, whatever their number was
  /// when it was saved. Errors are agreed. Collective.
  [[nodiscard]] Loaded load(MPI_Comm comm) const;

  /// True if there is something to load, readable or not.
  [[nodiscard]] bool exists() const;
  /// Removes both files, and what a kill left of an unfinished one.
  void remove() const;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
  [[nodiscard]] std::filesystem::path previous() const;
  [[nodiscard]] std::filesystem::path next() const;
  void rename() const;
  std::filesystem::path path_;
};

}  // namespace whirl::io
