#include "film/algebra/general_band.hpp"

#include <algorithm>

namespace whirl::film {
namespace {

// Four sums side by side: one alone would wait for each of its additions.
double product(const double* a, const double* b, int n) {
  double sum[4] = {0.0, 0.0, 0.0, 0.0};
  int k = 0;
  for (; k + 4 <= n; k += 4)
    for (int lane = 0; lane < 4; ++lane) sum[lane] += a[k + lane] * b[k + lane];
  for (; k < n; ++k) sum[0] += a[k] * b[k];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

}  // namespace

GeneralBand::GeneralBand(int size, int width)
    : size_(size),
      width_(width),
      stride_(static_cast<std::size_t>(2 * width + 1)),
      data_(static_cast<std::size_t>(size) * stride_, 0.0) {}

void GeneralBand::clear() {
  std::fill(data_.begin(), data_.end(), 0.0);
}

void GeneralBand::factor() {
  const int w = width_;
  for (int i = 0; i < size_; ++i) {
    double* const pivot = row(i) + w;
    const double inverse = 1.0 / pivot[0];
    const int reach = std::min(w, size_ - 1 - i);
    for (int r = 1; r <= reach; ++r) {
      double* const target = row(i + r) + w - r;  // A(i + r, i)
      if (target[0] == 0.0) continue;
      const double l = target[0] *= inverse;
      for (int c = 1; c <= reach; ++c) target[c] -= l * pivot[c];
    }
    pivot[0] = inverse;
  }
}

void GeneralBand::solve(std::span<double> x) const {
  const int w = width_;
  double* const at = x.data();
  for (int i = 1; i < size_; ++i) {
    const int reach = std::min(w, i);
    at[i] -= product(row(i) + w - reach, at + i - reach, reach);
  }
  for (int i = size_ - 1; i >= 0; --i) {
    const double* const own = row(i) + w;
    at[i] = own[0] * (at[i] - product(own + 1, at + i + 1, std::min(w, size_ - 1 - i)));
  }
}

void GeneralBand::solve_transposed(std::span<Quad> x) const {
  const int w = width_;
  Quad* const at = x.data();
  for (int i = 0; i < size_; ++i) {
    const double* const own = row(i) + w;
    const Quad known = at[i] = own[0] * at[i];
    for (int r = std::min(w, size_ - 1 - i); r > 0; --r) at[i + r] -= own[r] * known;
  }
  for (int i = size_ - 1; i > 0; --i) {
    const double* const own = row(i) + w;
    const Quad known = at[i];
    for (int r = std::min(w, i); r > 0; --r) at[i - r] -= own[-r] * known;
  }
}

}  // namespace whirl::film
