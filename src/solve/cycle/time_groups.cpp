#include "whirl/solve/cycle/time_groups.hpp"

#include <exception>
#include <vector>

#include "whirl/core/agree.hpp"
#include "whirl/core/count.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int tag = 71;

int mpi_count(Index n) {
  return core::count_of(n, "numbers in a message");
}

}  // namespace

TimeGroups::TimeGroups(MPI_Comm all, MPI_Comm time)
    : all_(all), time_(time), count_(core::size_of(time)), index_(core::rank_of(time)) {}

// What one rank of a group throws by itself leaves the others of its group behind: they wait, so it has to end the run.
bool TimeGroups::alone(const core::Error& e) const {
  return !e.agreed() && core::size_of(all_) > count_;
}

void TimeGroups::together(const std::function<void()>& work) const {
  if (count_ == 1) return work();
  std::exception_ptr caught;
  try {
    work();
  } catch (const core::Error& e) {
    if (alone(e)) throw;
    caught = std::current_exception();
  }
  core::agree(all_, [&] {
    if (caught) std::rethrow_exception(caught);
  });
}

void TimeGroups::in_turn(MatrixXd& state, const std::function<void()>& work, bool back) const {
  if (count_ == 1) return work();
  const Index rows = state.rows(), columns = state.cols();
  const int n = mpi_count(state.size()), before = back ? index_ + 1 : index_ - 1,
            after = back ? index_ - 1 : index_ + 1;
  const auto exists = [&](int group) { return group >= 0 && group < count_; };
  together([&] {
    std::exception_ptr caught;
    char failed = 0;
    if (exists(before)) {
      MPI_Recv(&failed, 1, MPI_CHAR, before, tag, time_, MPI_STATUS_IGNORE);
      MPI_Recv(state.data(), n, MPI_DOUBLE, before, tag, time_, MPI_STATUS_IGNORE);
    }
    if (failed == 0) try {
        work();
        core::require(state.rows() == rows && state.cols() == columns, "a state that keeps its shape");
      } catch (const core::Error& e) {
        if (alone(e)) throw;
        caught = std::current_exception();
        failed = 1;
        state.setZero(rows, columns);
      }
    if (exists(after)) {
      MPI_Send(&failed, 1, MPI_CHAR, after, tag, time_);
      MPI_Send(state.data(), n, MPI_DOUBLE, after, tag, time_);
    }
    MPI_Bcast(state.data(), n, MPI_DOUBLE, back ? 0 : count_ - 1, time_);
    if (caught) std::rethrow_exception(caught);
  });
}

VectorXd TimeGroups::from_before(const VectorXd& own) const {
  if (count_ == 1) return own;
  VectorXd out(own.size());
  const int n = mpi_count(own.size());
  MPI_Sendrecv(own.data(), n, MPI_DOUBLE, (index_ + 1) % count_, tag, out.data(), n, MPI_DOUBLE,
               (index_ + count_ - 1) % count_, tag, time_, MPI_STATUS_IGNORE);
  return out;
}

MatrixXd TimeGroups::joined(const MatrixXd& own, Index intervals) const {
  if (count_ == 1) return own;
  const Index here = first(intervals, index_ + 1) - first(intervals, index_), each = own.cols() / here;
  core::require(own.cols() == each * here, "as many columns for each interval");
  MatrixXd out(own.rows(), each * intervals);
  for (int g = 0; g < count_; ++g) {
    const Index from = each * first(intervals, g), columns = each * first(intervals, g + 1) - from;
    if (g == index_) out.middleCols(from, columns) = own;
    MPI_Bcast(out.data() + from * out.rows(), mpi_count(columns * out.rows()), MPI_DOUBLE, g, time_);
  }
  return out;
}

}  // namespace whirl::solve
