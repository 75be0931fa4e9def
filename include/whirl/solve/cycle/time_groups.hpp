#pragma once
// Groups of ranks that share the intervals of a cycle.

#include <mpi.h>

#include <Eigen/Core>
#include <functional>

namespace whirl::core {
class Error;
}

namespace whirl::solve {

/// Groups of ranks, each of which holds a whole system on a communicator of its own and a run of the intervals of a
/// cycle. All groups are of one size and split the system alike, so that a state has the same rows on the same rank of
/// each group.
///
/// What depends on states at one time alone is computed by all groups from equal numbers; they take the same decisions.
class TimeGroups {
public:
  /// One group: the ranks of `all`.
  explicit TimeGroups(MPI_Comm all) : all_(all) {}
  /// `all`: the ranks of all groups. `time`: those with the same rows, in the order of the groups.
  TimeGroups(MPI_Comm all, MPI_Comm time);

  [[nodiscard]] MPI_Comm all() const { return all_; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] int index() const { return index_; }
  /// Of n intervals, the first one of a group.
  [[nodiscard]] Eigen::Index first(Eigen::Index n, int group) const { return n * group / count_; }

  /// Runs `work` in each group, on intervals of its own; if it throws in one, all ranks throw as in core::agree().
  void together(const std::function<void()>& work) const;
  /// Runs `work` in one group after the other: it takes `state` through the intervals of its group, and the next group
  /// goes on from there; `back`: from the last group to the first. In the end all have the state of the group that was
  /// the last to work. Throws as together().
  void in_turn(Eigen::MatrixXd& state, const std::function<void()>& work, bool back = false) const;
  /// What the group before this one has in `own`, round in a ring.
  [[nodiscard]] Eigen::VectorXd from_before(const Eigen::VectorXd& own) const;
  /// From this rank's columns, as many for each of its intervals, those of all `intervals`.
  [[nodiscard]] Eigen::MatrixXd joined(const Eigen::MatrixXd& own, Eigen::Index intervals) const;

private:
  [[nodiscard]] bool alone(const core::Error& e) const;
  MPI_Comm all_, time_ = MPI_COMM_SELF;
  int count_ = 1, index_ = 0;
};

}  // namespace whirl::solve
