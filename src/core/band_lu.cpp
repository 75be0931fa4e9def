#include "whirl/core/band_lu.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <utility>

#include "whirl/core/index.hpp"

namespace whirl::core {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

int BandLu::bandwidth(const Sparse& pattern) {
  int width = 0;
  for (int k = 0; k < pattern.outerSize(); ++k)
    for (Sparse::InnerIterator it(pattern, k); it; ++it)
      width = std::max(width, std::abs(static_cast<int>(it.row() - it.col())));
  return width;
}

// Nested dissection of n states takes some 30 n^1.5 operations, which are several times slower one by one than those of
// a band side by side.
bool BandLu::pays(double states, double width) {
  constexpr double slower = 8.0;
  return 2.0 * width * width <= slower * 30.0 * std::sqrt(states);
}

namespace {

constexpr int lanes = 8;  // rows side by side, in an Eight

typedef double Eight __attribute__((vector_size(8 * lanes)));

int whole(int n, int of) {
  return (n + of - 1) / of * of;
}

Eight at(const double* from) {
  Eight x;
  std::memcpy(&x, from, sizeof x);
  return x;
}
void put(double* to, const Eight& value) {
  std::memcpy(to, &value, sizeof value);
}
// One lane in all of them.
Eight spread(const Eight& x, int lane) {
  const double y = x[lane];
  return Eight{y, y, y, y, y, y, y, y};
}
double sum(const Eight& x) {
  return ((x[0] + x[4]) + (x[1] + x[5])) + ((x[2] + x[6]) + (x[3] + x[7]));
}
// Zeros, on the stack if they are few: many small bands are solved.
class Room {
public:
  explicit Room(std::ptrdiff_t size) : many_(size > few ? core::at(size) : 0, 0.0) {
    if (size <= few) std::fill_n(few_.begin(), size, 0.0);
  }
  double* data() { return many_.empty() ? few_.data() : many_.data(); }

private:
  static constexpr std::ptrdiff_t few = 512;
  std::array<double, few> few_;
  std::vector<double> many_;
};
constexpr Eight lane_number = {0, 1, 2, 3, 4, 5, 6, 7};

}  // namespace

BandLu::BandLu(const Sparse& pattern, VectorXd units, double most)
    : BandLu(static_cast<int>(pattern.rows()), bandwidth(pattern), std::move(units), most) {}

BandLu::BandLu(int size, int width, VectorXd units, double most)
    : size_(size),
      width_(std::max(width, at_once)),
      height_(whole(width_, lanes)),
      stride_(whole(2 * width_ + 1 + 2 * lanes, lanes)),
      most_(most),
      units_(units.size() == 0 ? VectorXd::Ones(size_) : std::move(units)),
      scale_(VectorXd::Ones(size_)) {
  // Zeros before the first column and behind those that the last of them reach.
  band_.resize(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(size_ + width_ + 2 * at_once) + lanes);
  panel_.resize(static_cast<std::size_t>(at_once * height_));
}

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
  regular_ = scale_rows(a);
  if (!regular_) return false;
  exchanged_ = false;
  eliminate({.a = &a});
  const VectorXd image = a * units_;
  loss_ = (solve(image) - units_).cwiseQuotient(units_).lpNorm<Eigen::Infinity>();
  exchanged_ = !(loss_ <= most_);
  if (!exchanged_) return true;
  loss_ = most_;
  const Sparse scaled = scale_.asDiagonal() * a * units_.asDiagonal();
  if (pivoted_.size() == 0) pivoted_.analyse(scaled);
  regular_ = pivoted_.factorise(scaled);
  return regular_;
}

void BandLu::clear() {
  std::fill(band_.begin(), band_.end(), 0.0);
  for (int k = size_; k < whole(size_, lanes); ++k) entry(k, k) = 1.0;  // solutions take eight at a time
}

void BandLu::lay_out(int first, int end, const Source& of) {
  if (of.base && first < end)
    std::copy_n(of.base->column(first) + first - width_, std::ptrdiff_t{stride_} * (end - first),
                column(first) + first - width_);
  if (!of.a) return;
  for (int k = first; k < end; ++k) {
    double* const c = column(k);
    std::fill(c + k - width_, c + k - width_ + stride_, 0.0);
    if (k >= size_) {
      c[k] = 1.0;  // nothing lies beside it
      continue;
    }
    for (Sparse::InnerIterator it(*of.a, k); it; ++it) c[it.row()] = scale_(it.row()) * it.value() * units_(k);
  }
}

// Right-looking, four columns at a time: the square of their rows by itself, then what lies below it, then the columns
// behind, which are read and written once for all four. A pivot of zero shows in what is tried afterwards. The diagonal
// holds the reciprocals of the pivots. What lies below the square stays in registers, in so many vectors, or is read
// again if that is 0. Columns are laid out shortly before they are needed, while they are in the cache.
template <int Vectors>
void BandLu::eliminate(const Source& of) {
  const int end = whole(size_, at_once), h = Vectors > 0 ? Vectors * lanes : height_;
  double* const l = panel_.data();
  int laid_out = of.first > 0 ? std::min(of.first + width_, end) : 0;
  const auto marked = [&](int k) { return std::ptrdiff_t{stride_} * (std::min(k + width_, end) - k); };
  if (of.first > 0 && of.first < end)
    std::copy_n(marked_.begin(), marked(of.first), column(of.first) + of.first - width_);
  for (int k = of.first; k < end; k += at_once) {
    if (k == of.mark && k != of.first) {
      const double* const from = column(k) + k - width_;
      marked_.assign(from, from + marked(k));
    }
    const int needed = k + at_once < end ? std::min(k + at_once + width_, end) : whole(size_, lanes);
    lay_out(std::exchange(laid_out, needed), needed, of);
    for (int i = k; i < std::min(k + at_once, size_) && !of.extra.empty(); ++i)
      column(i)[i] += of.extra[static_cast<std::size_t>(i)];
    double *const c0 = column(k), *const c1 = column(k + 1), *const c2 = column(k + 2), *const c3 = column(k + 3);
    const double p0 = c0[k] = 1.0 / c0[k];
    const double l10 = c0[k + 1] *= p0, l20 = c0[k + 2] *= p0, l30 = c0[k + 3] *= p0;
    const double u01 = c1[k], p1 = c1[k + 1] = 1.0 / (c1[k + 1] - l10 * u01);
    const double l21 = c1[k + 2] = (c1[k + 2] - l20 * u01) * p1, l31 = c1[k + 3] = (c1[k + 3] - l30 * u01) * p1;
    const double u02 = c2[k], u12 = c2[k + 1] -= l10 * u02;
    const double p2 = c2[k + 2] = 1.0 / (c2[k + 2] - l20 * u02 - l21 * u12);
    const double l32 = c2[k + 3] = (c2[k + 3] - l30 * u02 - l31 * u12) * p2;
    const double u03 = c3[k], u13 = c3[k + 1] -= l10 * u03, u23 = c3[k + 2] -= l20 * u03 + l21 * u13;
    const double p3 = c3[k + 3] = 1.0 / (c3[k + 3] - l30 * u03 - l31 * u13 - l32 * u23);
    const int below = k + at_once, last = std::min(below + width_, size_);
    std::array<std::array<Eight, at_once>, static_cast<std::size_t>(std::max(Vectors, 1))> kept;
    for (int r = 0; r < h; r += lanes) {
      const Eight x0 = at(c0 + below + r) * p0, x1 = (at(c1 + below + r) - x0 * u01) * p1,
                  x2 = (at(c2 + below + r) - x0 * u02 - x1 * u12) * p2,
                  x3 = (at(c3 + below + r) - x0 * u03 - x1 * u13 - x2 * u23) * p3;
      put(c0 + below + r, x0);
      put(c1 + below + r, x1);
      put(c2 + below + r, x2);
      put(c3 + below + r, x3);
      if constexpr (Vectors > 0) {
        kept[static_cast<std::size_t>(r / lanes)] = {x0, x1, x2, x3};
      } else {
        double* const to = l + at_once * r;
        put(to, x0), put(to + lanes, x1), put(to + 2 * lanes, x2), put(to + 3 * lanes, x3);
      }
    }
    for (int j = below; j < last; ++j) {
      double* const own = column(j);
      const double u0 = own[k], u1 = own[k + 1] -= l10 * u0, u2 = own[k + 2] -= l20 * u0 + l21 * u1,
                   u3 = own[k + 3] -= l30 * u0 + l31 * u1 + l32 * u2;
      double* const rest = own + below;
      if constexpr (Vectors > 0) {
        for (std::size_t v = 0; v < Vectors; ++v) {
          const auto& x = kept[v];
          double* const to = rest + static_cast<std::ptrdiff_t>(v) * lanes;
          put(to, at(to) - (x[0] * u0 + x[1] * u1 + x[2] * u2 + x[3] * u3));
        }
      } else {
        for (int r = 0; r < h; r += lanes) {
          const double* const x = l + at_once * r;
          put(rest + r,
              at(rest + r) - (at(x) * u0 + at(x + lanes) * u1 + at(x + 2 * lanes) * u2 + at(x + 3 * lanes) * u3));
        }
      }
    }
  }
}

void BandLu::eliminate(const Source& of) {
  if (!of.a) {
    regular_ = true;
    exchanged_ = false;
    scale_.setOnes();
  }
  switch (height_ / lanes) {
    case 1:
      return eliminate<1>(of);
    case 2:
      return eliminate<2>(of);
    case 3:
      return eliminate<3>(of);
    case 4:
      return eliminate<4>(of);
    default:
      return eliminate<0>(of);
  }
}

// Eight columns at a time: what they take from the rows below is read and written in the same vectors by the next
// eight.
template <int Sides>
void BandLu::substitute(const double* b, double* to) const {
  const int end = whole(size_, lanes), h = height_;
  // Room for the rows of columns that are none of the matrix.
  const std::ptrdiff_t apart = end + 2 * h;
  Room padded(Sides * apart);
  std::array<double*, Sides> x;
  for (std::size_t s = 0; s < Sides; ++s) {
    x[s] = padded.data() + h + static_cast<std::ptrdiff_t>(s) * apart;
    const double* const from = b + static_cast<std::ptrdiff_t>(s) * size_;
    for (int k = 0; k < size_; ++k) x[s][k] = scale_(k) * from[k];
  }
  std::array<std::array<Eight, lanes>, Sides> solved;
  const auto take = [&](int k, int first) {
    for (int r = first; r < first + h; r += lanes)
      for (std::size_t s = 0; s < Sides; ++s) {
        const auto& y = solved[s];
        Eight even = at(column(k) + r) * y[0], odd = at(column(k + 1) + r) * y[1];
        for (int i = 2; i < lanes; i += 2) {
          even += at(column(k + i) + r) * y[static_cast<std::size_t>(i)];
          odd += at(column(k + i + 1) + r) * y[static_cast<std::size_t>(i + 1)];
        }
        put(x[s] + r, at(x[s] + r) - (even + odd));
      }
  };
  for (int k = 0; k < end; k += lanes) {
    std::array<Eight, Sides> now;
    for (std::size_t s = 0; s < Sides; ++s) now[s] = at(x[s] + k);
#pragma GCC unroll 8
    for (int i = 0; i < lanes; ++i) {
      const Eight below = lane_number > static_cast<double>(i) ? at(column(k + i) + k) : Eight{};
      for (std::size_t s = 0; s < Sides; ++s) {
        const Eight y = spread(now[s], i);
        solved[s][static_cast<std::size_t>(i)] = y;
        now[s] -= below * y;
      }
    }
    for (std::size_t s = 0; s < Sides; ++s) put(x[s] + k, now[s]);
    take(k, k + lanes);
  }
  for (int k = end - lanes; k >= 0; k -= lanes) {
    std::array<Eight, Sides> now;
    for (std::size_t s = 0; s < Sides; ++s) now[s] = at(x[s] + k);
#pragma GCC unroll 8
    for (int i = lanes - 1; i >= 0; --i) {
      const double* const c = column(k + i) + k;
      const Eight above = lane_number < static_cast<double>(i) ? at(c) : Eight{};
      for (std::size_t s = 0; s < Sides; ++s) {
        const Eight y = spread(now[s], i) * c[i];
        solved[s][static_cast<std::size_t>(i)] = y;
        now[s] = lane_number == static_cast<double>(i) ? y : now[s] - above * y;
      }
    }
    for (std::size_t s = 0; s < Sides; ++s) put(x[s] + k, now[s]);
    take(k, k - h);
  }
  for (std::size_t s = 0; s < Sides; ++s)
    for (int k = 0; k < size_; ++k) to[static_cast<std::ptrdiff_t>(s) * size_ + k] = units_(k) * x[s][k];
}

template <int Sides>
void BandLu::substitute_transposed(const double* b, double* to) const {
  const int end = whole(size_, at_once), h = height_;
  const auto columns = [](double* first, int stride) {
    std::array<double*, Sides> out;
    for (std::size_t s = 0; s < Sides; ++s) out[s] = first + static_cast<std::ptrdiff_t>(s) * stride;
    return out;
  };
  Room padded(Sides * (end + 2 * h));
  const auto x = columns(padded.data() + h, end + 2 * h);
  for (std::size_t s = 0; s < Sides; ++s)
    for (int k = 0; k < size_; ++k) x[s][k] = units_(k) * b[static_cast<std::ptrdiff_t>(s) * size_ + k];
  // What four columns take from the rows [from, from + h), for each side.
  std::array<std::array<double, at_once>, Sides> taken;
  const auto take = [&](int k, int from) {
    const std::array<const double*, at_once> c = {column(k), column(k + 1), column(k + 2), column(k + 3)};
    std::array<std::array<Eight, at_once>, Sides> sum;
    for (auto& side : sum)
      for (Eight& lane : side) lane = Eight{};
    for (int r = from; r < from + h; r += lanes)
      for (std::size_t s = 0; s < Sides; ++s) {
        const Eight here = at(x[s] + r);
        for (std::size_t i = 0; i < at_once; ++i) sum[s][i] += at(c[i] + r) * here;
      }
    for (std::size_t s = 0; s < Sides; ++s)
      for (std::size_t i = 0; i < at_once; ++i) taken[s][i] = whirl::core::sum(sum[s][i]);
  };
  for (int k = 0; k < end; k += at_once) {
    const double *const u0 = column(k), *const u1 = column(k + 1), *const u2 = column(k + 2), *const u3 = column(k + 3);
    take(k, k - h);
    for (std::size_t s = 0; s < Sides; ++s) {
      double* const y = x[s] + k;
      const auto& t = taken[s];
      y[0] = (y[0] - t[0]) * u0[k];
      y[1] = (y[1] - t[1] - u1[k] * y[0]) * u1[k + 1];
      y[2] = (y[2] - t[2] - u2[k] * y[0] - u2[k + 1] * y[1]) * u2[k + 2];
      y[3] = (y[3] - t[3] - u3[k] * y[0] - u3[k + 1] * y[1] - u3[k + 2] * y[2]) * u3[k + 3];
    }
  }
  for (int k = end - at_once; k >= 0; k -= at_once) {
    const double *const l0 = column(k), *const l1 = column(k + 1), *const l2 = column(k + 2);
    take(k, k + at_once);
    for (std::size_t s = 0; s < Sides; ++s) {
      double* const y = x[s] + k;
      const auto& t = taken[s];
      y[3] -= t[3];
      y[2] -= t[2] + l2[k + 3] * y[3];
      y[1] -= t[1] + l1[k + 2] * y[2] + l1[k + 3] * y[3];
      y[0] -= t[0] + l0[k + 1] * y[1] + l0[k + 2] * y[2] + l0[k + 3] * y[3];
    }
  }
  for (std::size_t s = 0; s < Sides; ++s)
    for (int k = 0; k < size_; ++k) to[static_cast<std::ptrdiff_t>(s) * size_ + k] = scale_(k) * x[s][k];
}

void BandLu::solve(bool transposed, const double* y, double* x, Index columns) const {
  if (!regular_) {
    std::fill_n(x, size_ * columns, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  if (exchanged_) {
    const VectorXd &before = transposed ? units_ : scale_, &after = transposed ? scale_ : units_;
    const MatrixXd right = before.asDiagonal() * Eigen::Map<const MatrixXd>(y, size_, columns);
    Eigen::Map<MatrixXd> found(x, size_, columns);
    found = transposed ? pivoted_.solve_transposed(right) : pivoted_.solve(right);
    found.array().colwise() *= after.array();
    return;
  }
  Index c = 0;
  for (; c + 4 <= columns; c += 4)
    transposed ? substitute_transposed<4>(y + c * size_, x + c * size_) : substitute<4>(y + c * size_, x + c * size_);
  for (; c + 2 <= columns; c += 2)
    transposed ? substitute_transposed<2>(y + c * size_, x + c * size_) : substitute<2>(y + c * size_, x + c * size_);
  if (c < columns)
    transposed ? substitute_transposed<1>(y + c * size_, x + c * size_) : substitute<1>(y + c * size_, x + c * size_);
}

}  // namespace whirl::core
