#include "whirl/core/pivoted_band.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace whirl::core {

using Eigen::Index;

void PivotedBand::resize(Index n, Index reach) {
  reach_ = reach;
  rows_.setZero(3 * reach + 1, n);
  lower_.resize(reach, n);
  pivot_.resize(static_cast<std::size_t>(n));
}

bool PivotedBand::factorise() {
  const Index n = rows_.cols();
  bool regular = true;
  for (Index k = 0; k < n; ++k) {
    const Index last = std::min(n - 1, k + reach_), right = std::min(n - 1, k + 2 * reach_);
    Index p = k;
    for (Index i = k + 1; i <= last; ++i)
      if (std::abs(at(i, k)) > std::abs(at(p, k))) p = i;
    pivot_[static_cast<std::size_t>(k)] = p;
    if (p != k)
      for (Index j = k; j <= right; ++j) std::swap(at(k, j), at(p, j));
    regular = regular && at(k, k) != 0;
    for (Index i = k + 1; i <= last; ++i) {
      const double factor = at(i, k) / at(k, k);
      lower_(i - k - 1, k) = factor;
      if (factor == 0) continue;
      for (Index j = k + 1; j <= right; ++j) at(i, j) -= factor * at(k, j);
    }
  }
  return regular;
}

void PivotedBand::solve(double* x) const {
  const Index n = rows_.cols();
  for (Index k = 0; k < n; ++k) {
    std::swap(x[k], x[pivot_[static_cast<std::size_t>(k)]]);
    for (Index i = 1; i <= std::min(reach_, n - 1 - k); ++i) x[k + i] -= lower_(i - 1, k) * x[k];
  }
  for (Index k = n - 1; k >= 0; --k) {
    double value = x[k];
    for (Index j = 1; j <= std::min(2 * reach_, n - 1 - k); ++j) value -= rows_(reach_ + j, k) * x[k + j];
    x[k] = value / rows_(reach_, k);
  }
}

void PivotedBand::solve_transposed(double* x) const {
  const Index n = rows_.cols();
  for (Index k = 0; k < n; ++k) {
    double value = x[k];
    for (Index j = 1; j <= std::min(2 * reach_, k); ++j) value -= rows_(reach_ + j, k - j) * x[k - j];
    x[k] = value / rows_(reach_, k);
  }
  for (Index k = n - 1; k >= 0; --k) {
    for (Index i = 1; i <= std::min(reach_, n - 1 - k); ++i) x[k] -= lower_(i - 1, k) * x[k + i];
    std::swap(x[k], x[pivot_[static_cast<std::size_t>(k)]]);
  }
}

}  // namespace whirl::core
