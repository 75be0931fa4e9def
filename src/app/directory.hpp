#pragma once
// The directory of results.

#include <mpi.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace whirl::app {

/// What to do with results of an earlier run.
enum class Earlier { refuse, resume, replace };

/// A directory of results, held by one run at a time.
///
/// The lock is the kernel's (flock on the directory), held by rank 0: it ends with the process, however that ends, and
/// leaves no file. On file systems that cannot lock a directory nobody is kept out, and `locked()` says so.
class Directory {
public:
  /// Makes `directory` ready for a run and writes `resolved.yaml` into it under a temporary name, then renames it.
  /// Collective. Throws core::InputError (agreed) if another run holds it, if there are earlier results and `earlier`
  /// does not say what to do with them, if they belong to another deck, or if the directory is not one of ours.
  /// `Earlier::replace` removes what the manifest names and nothing else. A folder or a pipe under one of the names of
  /// results, or of `files` that are to come, is refused.
  Directory(MPI_Comm comm, const std::string& directory, const std::string& resolved, Earlier earlier,
            const std::vector<std::string>& files = {});
  /// Takes back what the constructor made, if no study has left a result since: a deck that turned out to be wrong must
  /// not stand in the way of the right one. Rank 0 acts; throws nothing.
  void abandon() noexcept;
  /// Whether this rank holds the lock; rank 0 does unless the file system has none.
  [[nodiscard]] bool locked() const { return lock_.held(); }

private:
  // The descriptor whose lock goes when it is closed.
  class Lock {
  public:
    Lock() = default;
    explicit Lock(int descriptor) : descriptor_(descriptor) {}
    Lock(Lock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    Lock& operator=(Lock&& other) noexcept {
      std::swap(descriptor_, other.descriptor_);
      return *this;
    }
    ~Lock();
    [[nodiscard]] bool held() const { return descriptor_ >= 0; }

  private:
    int descriptor_ = -1;
  };
  void lock();
  void prepare(const std::string& resolved, Earlier earlier, const std::vector<std::string>& files);

  std::filesystem::path path_;
  Lock lock_;
  bool made_ = false, fresh_ = false;  // the directory was not there before, or held nothing
};

}  // namespace whirl::app
