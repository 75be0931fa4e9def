#include "film/band_lu.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

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
  return 2.0 * n * w * w <= slower * 30.0 * n * std::sqrt(n);
}

namespace {

constexpr int at_once = 4;  // columns that are taken off the rest together: it is read and written once for them
constexpr double lost = 1e-7;

}  // namespace

BandLu::BandLu(const Sparse& pattern, Eigen::VectorXd units)
    : size_(static_cast<int>(pattern.rows())),
      width_(bandwidth(pattern)),
      band_(static_cast<std::size_t>(2 * width_ + 1) * static_cast<std::size_t>(size_ + width_ + 2 * at_once)),
      panel_(static_cast<std::size_t>(at_once) * static_cast<std::size_t>(width_)),
      units_(units.size() == 0 ? Eigen::VectorXd::Ones(size_) : std::move(units)),
      scale_(size_) {}

bool BandLu::scale_rows(const Sparse& a) {
  scale_.setZero();
  for (int k = 0; k < size_; ++k)
    for (Sparse::InnerIterator it(a, k); it; ++it)
      scale_(it.row()) = std::max(scale_(it.row()), std::abs(it.value()) * units_(k));
  if (!(scale_.minCoeff() > 0.0) || !scale_.allFinite()) return false;
  scale_ = scale_.cwiseInverse();
  return true;
}

bool BandLu::factor(const Sparse& a) {
  if (!scale_rows(a)) return false;
  exchanged_ = false;
  if (factor_as_it_stands(a)) {
    const Eigen::VectorXd image = a * units_;
    if ((solve(image) - units_).cwiseQuotient(units_).lpNorm<Eigen::Infinity>() <= lost) return true;
  }
  exchanged_ = true;
  return factor_with_exchanges(a);
}

// Right-looking, four columns at a time. False if a pivot is zero.
bool BandLu::factor_as_it_stands(const Sparse& a) {
  std::fill(band_.begin(), band_.end(), 0.0);
  for (int k = 0; k < size_; ++k) {
    double* const to = column(k);
    for (Sparse::InnerIterator it(a, k); it; ++it) to[it.row()] = scale_(it.row()) * it.value() * units_(k);
  }
  const int w = width_;
  double* const l0 = panel_.data();
  double *const l1 = l0 + w, *const l2 = l1 + w, *const l3 = l2 + w;
  for (int k = 0; k < size_; k += at_once) {
    const int columns = std::min(at_once, size_ - k), next = k + columns;
    std::fill(panel_.begin(), panel_.end(), 0.0);
    for (int c = 0; c < columns; ++c) {
      const int pivot = k + c, last = std::min(pivot + w, size_ - 1);
      double* const own = column(pivot);
      const double over = 1.0 / own[pivot];
      if (!std::isfinite(over)) return false;
      for (int r = pivot + 1; r <= last; ++r) own[r] *= over;
      for (int d = c + 1; d < columns; ++d) {
        double* const other = column(k + d);
        const double times = k + d <= pivot + w ? other[pivot] : 0.0;
        for (int r = pivot + 1; r <= last; ++r) other[r] -= own[r] * times;
      }
      double* const l = l0 + static_cast<std::ptrdiff_t>(c) * w;
      for (int r = next; r <= last; ++r) l[r - next] = own[r];
    }
    const int end = std::min(next + w, size_);
    for (int j = next; j < end; ++j) {
      double* const own = column(j);
      // Its rows of the panel; those above its band are zero, and so is what they do.
      double u[at_once] = {};
      for (int c = 0; c < columns; ++c) {
        if (k + c < j - w) continue;
        double value = own[k + c];
        for (int b = 0; b < c; ++b) value -= column(k + b)[k + c] * u[b];
        own[k + c] = u[c] = value;
      }
      double* const rest = own + next;
      const double u0 = u[0], u1 = u[1], u2 = u[2], u3 = u[3];
      for (int r = 0; r < w; ++r) rest[r] -= l0[r] * u0 + l1[r] * u1 + l2[r] * u2 + l3[r] * u3;
    }
  }
  return true;
}

bool BandLu::factor_with_exchanges(const Sparse& a) {
  const int stride = 3 * width_ + 1;
  lapack_.assign(static_cast<std::size_t>(stride) * static_cast<std::size_t>(size_), 0.0);
  rows_.resize(static_cast<std::size_t>(size_));
  for (int k = 0; k < size_; ++k) {
    double* const to = lapack_.data() + static_cast<std::size_t>(stride) * static_cast<std::size_t>(k);
    for (Sparse::InnerIterator it(a, k); it; ++it)
      to[2 * width_ + it.row() - k] = scale_(it.row()) * it.value() * units_(k);
  }
  int info = 0;
  dgbtrf_(&size_, &size_, &width_, &width_, lapack_.data(), &stride, rows_.data(), &info);
  return info == 0;
}

Eigen::VectorXd BandLu::solved(char which, Eigen::VectorXd b) const {
  const int one = 1, stride = 3 * width_ + 1;
  int info = 0;
  dgbtrs_(&which, &size_, &width_, &width_, &one, lapack_.data(), &stride, rows_.data(), b.data(), &size_, &info);
  return b;
}

Eigen::VectorXd BandLu::solve(const Eigen::VectorXd& b) const {
  if (exchanged_) return units_.cwiseProduct(solved('N', scale_.cwiseProduct(b)));
  // Room for the rows of the band that are none of the matrix.
  Eigen::VectorXd padded = Eigen::VectorXd::Zero(size_ + 2 * width_);
  double* const x = padded.data() + width_;
  for (int k = 0; k < size_; ++k) x[k] = scale_(k) * b(k);
  for (int k = 0; k < size_; ++k) {
    const double* const l = column(k) + k + 1;
    double* const below = x + k + 1;
    const double times = x[k];
    for (int r = 0; r < width_; ++r) below[r] -= l[r] * times;
  }
  for (int k = size_ - 1; k >= 0; --k) {
    const double* const u = column(k) + k - width_;
    double* const above = x + k - width_;
    const double times = x[k] /= column(k)[k];
    for (int r = 0; r < width_; ++r) above[r] -= u[r] * times;
  }
  return units_.cwiseProduct(padded.segment(width_, size_));
}

Eigen::VectorXd BandLu::solve_transposed(const Eigen::VectorXd& b) const {
  if (exchanged_) return scale_.cwiseProduct(solved('T', units_.cwiseProduct(b)));
  Eigen::VectorXd padded = Eigen::VectorXd::Zero(size_ + 2 * width_);
  double* const x = padded.data() + width_;
  using Map = Eigen::Map<const Eigen::VectorXd>;
  for (int k = 0; k < size_; ++k)
    x[k] = (units_(k) * b(k) - Map(column(k) + k - width_, width_).dot(Map(x + k - width_, width_))) / column(k)[k];
  for (int k = size_ - 1; k >= 0; --k) x[k] -= Map(column(k) + k + 1, width_).dot(Map(x + k + 1, width_));
  return scale_.cwiseProduct(padded.segment(width_, size_));
}

}  // namespace whirl::film
