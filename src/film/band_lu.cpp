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
  // Four columns at a time: what is written is not read again at once, which would wait for it.
  const int w = width_, blocks = w >= at_once ? size_ - size_ % at_once : 0;
  for (int k = 0; k < blocks; k += at_once) {
    const double *const l0 = column(k), *const l1 = column(k + 1), *const l2 = column(k + 2), *const l3 = column(k + 3);
    const double x0 = x[k], x1 = x[k + 1] -= l0[k + 1] * x0, x2 = x[k + 2] -= l0[k + 2] * x0 + l1[k + 2] * x1,
                 x3 = x[k + 3] -= l0[k + 3] * x0 + l1[k + 3] * x1 + l2[k + 3] * x2;
    const int end = k + w + 1;
    for (int r = k + at_once; r < end; ++r) x[r] -= l0[r] * x0 + l1[r] * x1 + l2[r] * x2 + l3[r] * x3;
    x[end] -= l1[end] * x1 + l2[end] * x2 + l3[end] * x3;
    x[end + 1] -= l2[end + 1] * x2 + l3[end + 1] * x3;
    x[end + 2] -= l3[end + 2] * x3;
  }
  for (int k = blocks; k < size_; ++k) {
    const double* const l = column(k);
    for (int r = k + 1; r <= k + w; ++r) x[r] -= l[r] * x[k];
  }
  for (int k = size_ - 1; k >= blocks; --k) {
    const double* const u = column(k);
    const double times = x[k] /= u[k];
    for (int r = k - w; r < k; ++r) x[r] -= u[r] * times;
  }
  for (int k = blocks - at_once; k >= 0; k -= at_once) {
    const double *const u0 = column(k), *const u1 = column(k + 1), *const u2 = column(k + 2), *const u3 = column(k + 3);
    const double x3 = x[k + 3] /= u3[k + 3], x2 = x[k + 2] = (x[k + 2] - u3[k + 2] * x3) / u2[k + 2],
                 x1 = x[k + 1] = (x[k + 1] - u3[k + 1] * x3 - u2[k + 1] * x2) / u1[k + 1],
                 x0 = x[k] = (x[k] - u3[k] * x3 - u2[k] * x2 - u1[k] * x1) / u0[k];
    const int from = k + 3 - w;
    x[from - 3] -= u0[from - 3] * x0;
    x[from - 2] -= u0[from - 2] * x0 + u1[from - 2] * x1;
    x[from - 1] -= u0[from - 1] * x0 + u1[from - 1] * x1 + u2[from - 1] * x2;
    for (int r = from; r < k; ++r) x[r] -= u0[r] * x0 + u1[r] * x1 + u2[r] * x2 + u3[r] * x3;
  }
  return units_.cwiseProduct(padded.segment(width_, size_));
}

Eigen::VectorXd BandLu::solve_transposed(const Eigen::VectorXd& b) const {
  if (exchanged_) return scale_.cwiseProduct(solved('T', units_.cwiseProduct(b)));
  Eigen::VectorXd padded = Eigen::VectorXd::Zero(size_ + 2 * width_);
  double* const x = padded.data() + width_;
  const int w = width_;
  const auto dot = [&](const double* entries, int from, int end) {
    using Map = Eigen::Map<const Eigen::VectorXd>;
    return Map(entries + from, end - from).dot(Map(x + from, end - from));
  };
  // Four columns at a time, first with what the ones before left.
  for (int k = 0; k < size_; k += at_once) {
    const int end = std::min(k + at_once, size_);
    for (int c = k; c < end; ++c) x[c] = units_(c) * b(c) - dot(column(c), c - w, std::max(k, c - w));
    for (int c = k; c < end; ++c) {
      for (int r = std::max(k, c - w); r < c; ++r) x[c] -= column(c)[r] * x[r];
      x[c] /= column(c)[c];
    }
  }
  for (int k = size_; k > 0; k -= at_once) {
    const int from = std::max(k - at_once, 0);
    for (int c = from; c < k; ++c) x[c] -= dot(column(c), std::min(k, c + w + 1), c + w + 1);
    for (int c = k - 1; c >= from; --c)
      for (int r = c + 1; r < std::min(k, c + w + 1); ++r) x[c] -= column(c)[r] * x[r];
  }
  return scale_.cwiseProduct(padded.segment(width_, size_));
}

}  // namespace whirl::film
