#include "film/band_lu.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

extern "C" {
void dgbtrf_(const int* rows, const int* columns, const int* below, const int* above, double* band, const int* stride,
             int* exchanged, int* info);
void dgbtrs_(const char* which, const int* size, const int* below, const int* above, const int* sides,
             const double* band, const int* stride, const int* exchanged, double* x, const int* rows, int* info);
}

namespace whirl::film {

int BandLu::bandwidth(const Sparse& pattern) {
  int width = 0;
  for (int k = 0; k < pattern.outerSize(); ++k)
    for (Sparse::InnerIterator it(pattern, k); it; ++it)
      width = std::max(width, std::abs(static_cast<int>(it.row() - it.col())));
  return width;
}

// Nested dissection of n states takes some 30 n^1.5 operations, which are several times slower one by one than those of
// a band side by side.
bool BandLu::pays(const Sparse& pattern) {
  constexpr double slower = 8.0;
  const double n = static_cast<double>(pattern.rows()), w = bandwidth(pattern);
  return 4.0 * n * w * w <= slower * 30.0 * n * std::sqrt(n);
}

BandLu::BandLu(const Sparse& pattern)
    : size_(static_cast<int>(pattern.rows())),
      width_(bandwidth(pattern)),
      stride_(3 * width_ + 1),
      band_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(size_)),
      rows_(static_cast<std::size_t>(size_)),
      scale_(size_) {}

bool BandLu::factor(const Sparse& a) {
  scale_.setZero();
  for (int k = 0; k < size_; ++k)
    for (Sparse::InnerIterator it(a, k); it; ++it) scale_(it.row()) = std::max(scale_(it.row()), std::abs(it.value()));
  if (!(scale_.minCoeff() > 0.0) || !scale_.allFinite()) return false;
  scale_ = scale_.cwiseInverse();
  std::fill(band_.begin(), band_.end(), 0.0);
  for (int k = 0; k < size_; ++k) {
    double* const column = band_.data() + static_cast<std::size_t>(stride_) * static_cast<std::size_t>(k);
    for (Sparse::InnerIterator it(a, k); it; ++it) column[2 * width_ + it.row() - k] = scale_(it.row()) * it.value();
  }
  int info = 0;
  dgbtrf_(&size_, &size_, &width_, &width_, band_.data(), &stride_, rows_.data(), &info);
  return info == 0;
}

Eigen::VectorXd BandLu::solved(char which, Eigen::VectorXd b) const {
  const int one = 1;
  int info = 0;
  dgbtrs_(&which, &size_, &width_, &width_, &one, band_.data(), &stride_, rows_.data(), b.data(), &size_, &info);
  return b;
}

Eigen::VectorXd BandLu::solve(const Eigen::VectorXd& b) const {
  return solved('N', scale_.cwiseProduct(b));
}

Eigen::VectorXd BandLu::solve_transposed(const Eigen::VectorXd& b) const {
  return scale_.cwiseProduct(solved('T', b));
}

}  // namespace whirl::film
