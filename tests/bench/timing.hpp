#pragma once
// Timing for the benchmark programs: least of several runs, wall and processor time.

#include <mpi.h>

#include <algorithm>
#include <ctime>
#include <limits>

namespace whirl::bench {

inline double clock_seconds(clockid_t id) {
  timespec t{};
  clock_gettime(id, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Least wall time over the runs of the slowest rank, and least processor time over the runs of the busiest rank [s]:
/// on an idle machine the two agree, and waiting for another rank spins, so that it counts in both.
struct Timing {
  double wall = std::numeric_limits<double>::infinity(), processor = wall;
};

template <class Work>
Timing least(MPI_Comm comm, int runs, Work&& work) {
  Timing best;
  for (int k = 0; k < runs; ++k) {
    MPI_Barrier(comm);
    double t[2] = {-clock_seconds(CLOCK_MONOTONIC), -clock_seconds(CLOCK_PROCESS_CPUTIME_ID)};
    work();
    t[0] += clock_seconds(CLOCK_MONOTONIC);
    t[1] += clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    MPI_Allreduce(MPI_IN_PLACE, t, 2, MPI_DOUBLE, MPI_MAX, comm);
    best.wall = std::min(best.wall, t[0]);
    best.processor = std::min(best.processor, t[1]);
  }
  return best;
}

}  // namespace whirl::bench
