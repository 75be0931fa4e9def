#include "thermal/halo.hpp"

#include <algorithm>
#include <array>

namespace whirl::thermal {

Halo::Halo(const Rows& rows, std::size_t size, int width)
    : comm_(rows.comm()),
      size_(size),
      begin_(rows.begin()),
      end_(rows.end()),
      rank_(core::rank_of(rows.comm())),
      below_rows_(std::min(width, begin_)),
      above_rows_(std::min(width, rows.mesh().nodes_along() - end_)),
      below_(static_cast<std::size_t>(below_rows_) * size),
      above_(static_cast<std::size_t>(above_rows_) * size) {}

void Halo::exchange(const double* own) {
  own_ = own;
  // A neighbour wants as many rows of this rank as this rank wants of it: no rank holds fewer than the width.
  const auto count = [&](int rows) { return static_cast<int>(static_cast<std::size_t>(rows) * size_); };
  const int below = below_rows_ ? rank_ - 1 : MPI_PROC_NULL, above = above_rows_ ? rank_ + 1 : MPI_PROC_NULL;
  const double* last = own + static_cast<std::size_t>(end_ - begin_ - above_rows_) * size_;
  std::array<MPI_Request, 4> wait{};
  MPI_Irecv(below_.data(), count(below_rows_), MPI_DOUBLE, below, 0, comm_, &wait[0]);
  MPI_Irecv(above_.data(), count(above_rows_), MPI_DOUBLE, above, 1, comm_, &wait[1]);
  MPI_Isend(own, count(below_rows_), MPI_DOUBLE, below, 1, comm_, &wait[2]);
  MPI_Isend(last, count(above_rows_), MPI_DOUBLE, above, 0, comm_, &wait[3]);
  MPI_Waitall(4, wait.data(), MPI_STATUSES_IGNORE);
}

void Halo::isolate(const double* own) {
  own_ = own;
  std::fill(below_.begin(), below_.end(), 0.0);
  std::fill(above_.begin(), above_.end(), 0.0);
}

}  // namespace whirl::thermal
