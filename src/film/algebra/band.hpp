#pragma once
// Symmetric positive definite band matrices, A = L D L^T.

#include <span>

#include "film/algebra/pack.hpp"

namespace whirl::film {

/// Rows hold the diagonal and the `width` entries to its right: row(i)[r] = A(i, i + r).
class Band {
public:
  Band(int size, int width);
  double* row(int i) { return scalars(data_) + static_cast<std::size_t>(i) * stride_; }
  [[nodiscard]] const double* row(int i) const { return scalars(data_) + static_cast<std::size_t>(i) * stride_; }
  void clear();
  /// Replaces A by 1/D (diagonal) and the columns of L (right of it). Cost about size * width^2 multiplications.
  void factor() { eliminate({}, 0, size_); }
  /// The same of A + diag(extra), which starts again where only `extra` changed: the first call takes all rows and
  /// remembers what it finds in those from `mark` on; later ones, with first = mark, only do these. An infinite extra
  /// holds its unknown at zero. `base` is A.
  void factor(const Band& base, std::span<const double> extra, int first, int mark);
  /// x := A^-1 x after factor().
  void solve(std::span<double> x) const;
  /// x := A^-1 x for four right-hand sides side by side, after factor().
  void solve(std::span<Quad> x) const;

private:
  void eliminate(std::span<const double> extra, int first, int mark);
  template <std::size_t n>
  void forward(double* x) const;
  void forward_from(int first, double* x) const;
  int size_, width_;
  std::size_t stride_;
  std::vector<Pack> data_, pivot_;
  std::vector<Pack> marked_;  // rows mark .. mark + width when those before were eliminated
};

}  // namespace whirl::film
