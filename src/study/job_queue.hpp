#pragma once
// Independent jobs, taken by whichever group of ranks is free.

#include <mpi.h>

#include <cstddef>
#include <exception>
#include <functional>
#include <string>

namespace whirl::study {

/// Jobs 0 to n-1 for the ranks of `comm`, in groups of `ranks` (fewer where the ranks do not suffice). A counter on
/// rank 0 that all can reach says which is next, so that a group with short jobs takes more of them.
class JobQueue {
public:
  /// Collective on `comm`.
  JobQueue(MPI_Comm comm, int ranks, std::size_t n);
  JobQueue(const JobQueue&) = delete;
  JobQueue& operator=(const JobQueue&) = delete;
  ~JobQueue();

  /// Runs `job`, collective on group(), for each index that this group takes. If a job throws, no group takes another
  /// one, and the error leaves here on the ranks of that group alone.
  void run(const std::function<void(std::size_t)>& job);
  [[nodiscard]] MPI_Comm group() const { return group_; }

private:
  [[nodiscard]] std::size_t next();

  std::size_t n_;
  MPI_Comm group_ = MPI_COMM_SELF;
  MPI_Win window_ = MPI_WIN_NULL;
  long* counter_ = nullptr;
  int size_ = 1;
  int flying_ = std::uncaught_exceptions();
};

/// What `make` returns on the rank `owner` of `comm`, on all ranks; the others do not call it. If it throws, all ranks
/// throw as in core::agree(). Collective.
[[nodiscard]] std::string from_owner(MPI_Comm comm, int owner, const std::function<std::string()>& make);

}  // namespace whirl::study
