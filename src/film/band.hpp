#pragma once
// Symmetric positive definite band matrices, A = L D L^T.

#include <span>

#include "film/pack.hpp"

namespace whirl::film {

/// Rows hold the diagonal and the `width` entries to its right: row(i)[r] = A(i, i + r).
class Band {
public:
  Band(int size, int width);
  double* row(int i) { return scalars(data_) + static_cast<std::size_t>(i) * stride_; }
  [[nodiscard]] const double* row(int i) const { return scalars(data_) + static_cast<std::size_t>(i) * stride_; }
  void clear();
  /// Replaces A by 1/D (diagonal) and the columns of L (right of it). Cost about size * width^2 multiplications.
  void factor();
  /// x := A^-1 x for four right-hand sides side by side, after factor().
  void solve(std::span<Quad> x) const;

private:
  int size_, width_;
  std::size_t stride_;
  std::vector<Pack> data_, pivot_;
};

}  // namespace whirl::film
