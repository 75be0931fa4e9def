#pragma once
// How a run's ranks share the work: the one place where the world is split.

#include <mpi.h>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "whirl/system/options.hpp"

namespace whirl::study {

class Pieces;

/// Groups of ranks, each of which holds a whole system on its `space` communicator; independent work (speeds,
/// collocation intervals) is shared between groups.
///
/// A shaft of fewer than 20 000 freedoms fits one rank's cache and its solves are over before a message arrives, so
/// that every rank is a group of its own; a larger one is spread over all ranks as one group.
struct Groups {
  MPI_Comm world = MPI_COMM_NULL, space = MPI_COMM_NULL;
  int count = 1;  ///< number of groups
  int index = 0;  ///< of this rank's group

  [[nodiscard]] static Groups split(MPI_Comm world, const system::Machine& machine);
};

/// Who shares the intervals of a cycle: the ranks of `comm`, or each rank by itself where there are more ranks than
/// intervals; then all of them compute the same.
[[nodiscard]] MPI_Comm sharing_time(MPI_Comm comm, std::size_t intervals);

/// Runs work(0), ..., work(n - 1), shared between the groups in contiguous runs, and gives all answers to all ranks.
/// `work` is collective on the space communicator. If one item throws, all ranks throw. Collective on the world.
[[nodiscard]] std::vector<std::vector<double>> distribute(const Groups& groups, std::size_t n,
                                                          const std::function<std::vector<double>(std::size_t)>& work);

/// What an item leaves behind from which the next one starts, as numbers: to be read after an item, and to be put back
/// where a resumed run takes an item as it was kept.
struct Trail {
  std::function<std::vector<double>()> leave;
  std::function<void(const std::vector<double>&)> take;
};

/// The same in rounds of about a quarter of a second, after which the answers are `kept` as pieces `name 1`, ..., `name
/// n`: those of an interrupted run are not computed again, and on one rank the others start from what they would have
/// started from.
[[nodiscard]] std::vector<std::vector<double>> distribute(const Groups& groups, std::size_t n,
                                                          const std::function<std::vector<double>(std::size_t)>& work,
                                                          Pieces& kept, const std::string& name, const Trail& trail);

}  // namespace whirl::study
