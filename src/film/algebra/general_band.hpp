#pragma once
// Band matrices without symmetry, A = L U without row exchanges.

#include <span>
#include <vector>

#include "film/algebra/pack.hpp"

namespace whirl::film {

/// Rows hold `width` entries on either side of the diagonal: row(i)[width + r] = A(i, i + r). For matrices whose
/// columns are diagonally dominant, which need no exchange of rows.
class GeneralBand {
public:
  GeneralBand(int size, int width);
  double* row(int i) { return data_.data() + static_cast<std::size_t>(i) * stride_; }
  [[nodiscard]] const double* row(int i) const { return data_.data() + static_cast<std::size_t>(i) * stride_; }
  void clear();
  /// Replaces A by L (left of the diagonal), 1/diagonal of U, and U. Cost about 2 size width^2 operations.
  void factor();
  /// x := A^-1 x after factor().
  void solve(std::span<double> x) const;
  /// x := A^-T x for four right-hand sides side by side, after factor().
  void solve_transposed(std::span<Quad> x) const;

private:
  int size_, width_;
  std::size_t stride_;
  std::vector<double> data_;
};

}  // namespace whirl::film
