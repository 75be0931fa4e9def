#include "job_queue.hpp"

#include <algorithm>

#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::study {

JobQueue::JobQueue(MPI_Comm comm, int ranks, std::size_t n) : n_(n), size_(core::size_of(comm)) {
  const int rank = core::rank_of(comm), each = std::min(ranks, size_);
  if (size_ == 1) return;
  // The last group takes what is left over, so that none is smaller than asked for.
  const int groups = size_ / each;
  if (each > 1 || groups == 1) MPI_Comm_split(comm, std::min(rank / each, groups - 1), rank, &group_);
  MPI_Win_allocate(rank == 0 ? sizeof(long) : 0, sizeof(long), MPI_INFO_NULL, comm, &counter_, &window_);
  if (rank == 0) *counter_ = 0;
  MPI_Barrier(comm);
  MPI_Win_lock_all(0, window_);
}

JobQueue::~JobQueue() {
  // An error that only this rank has ends the run: the others are at work and would not come to free anything.
  if (std::uncaught_exceptions() > flying_) return;
  if (window_ != MPI_WIN_NULL) {
    MPI_Win_unlock_all(window_);
    MPI_Win_free(&window_);
  }
  if (group_ != MPI_COMM_SELF) MPI_Comm_free(&group_);
}

std::size_t JobQueue::next() {
  long index = 0;
  if (core::rank_of(group_) == 0) {
    const long one = 1;
    MPI_Fetch_and_op(&one, &index, MPI_LONG, 0, 0, MPI_SUM, window_);
    MPI_Win_flush(0, window_);
  }
  MPI_Bcast(&index, 1, MPI_LONG, 0, group_);
  return static_cast<std::size_t>(index);
}

void JobQueue::run(const std::function<void(std::size_t)>& job) {
  if (size_ == 1) {
    for (std::size_t k = 0; k < n_; ++k) job(k);
    return;
  }
  try {
    for (std::size_t k = next(); k < n_; k = next()) job(k);
  } catch (...) {
    if (core::rank_of(group_) == 0) {
      const long end = static_cast<long>(n_);
      long before = 0;
      MPI_Fetch_and_op(&end, &before, MPI_LONG, 0, 0, MPI_REPLACE, window_);
      MPI_Win_flush(0, window_);
    }
    throw;
  }
}

std::string from_owner(MPI_Comm comm, int owner, const std::function<std::string()>& make) {
  std::string bytes;
  core::agree(comm, [&] {
    if (core::rank_of(comm) == owner) bytes = make();
  });
  unsigned long size = bytes.size();
  MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG, owner, comm);
  core::agree(comm, [&] { bytes.resize(size); });
  constexpr unsigned long most = 1UL << 30;  // a count of MPI is an int
  for (unsigned long at = 0; at < size; at += most)
    MPI_Bcast(bytes.data() + at, static_cast<int>(std::min(most, size - at)), MPI_CHAR, owner, comm);
  return bytes;
}

}  // namespace whirl::study
