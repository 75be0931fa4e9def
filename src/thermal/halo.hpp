#pragma once
// Values in the rows of neighbouring ranks.

#include <mpi.h>

#include <cstddef>
#include <vector>

#include "whirl/thermal/rows.hpp"

namespace whirl::thermal {

/// Numbers in rows j: those of this rank, which are not copied, and those next to them on the neighbouring ranks.
class Halo {
public:
  /// `size` numbers in a row; up to `width` rows beyond those of this rank, no more than any rank holds.
  Halo(const Rows& rows, std::size_t size, int width);
  /// Takes `own` [r, size], which must stay where it is while rows are read, and fetches what lies beyond. Collective.
  void exchange(const double* own);
  /// The same with zeros beyond. Not collective.
  void isolate(const double* own);
  /// Row j [size], null where the film has ended or where it lies too far away.
  [[nodiscard]] const double* row(int j) const {
    if (j < begin_ - below_rows_ || j >= end_ + above_rows_) return nullptr;
    if (j < begin_) return below_.data() + static_cast<std::size_t>(j - begin_ + below_rows_) * size_;
    if (j >= end_) return above_.data() + static_cast<std::size_t>(j - end_) * size_;
    return own_ + static_cast<std::size_t>(j - begin_) * size_;
  }

private:
  MPI_Comm comm_;
  std::size_t size_;
  int begin_, end_, rank_;
  int below_rows_, above_rows_;
  const double* own_ = nullptr;
  std::vector<double> below_, above_;
};

}  // namespace whirl::thermal
