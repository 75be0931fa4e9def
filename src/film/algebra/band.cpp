#include "film/algebra/band.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace whirl::film {

Band::Band(int size, int width)
    : size_(size),
      width_(width),
      stride_(packs(width + 1) * kLanes),
      data_(static_cast<std::size_t>(size) * packs(width + 1), Pack::zero()),
      pivot_(2 * packs(width + 1) + 1, Pack::zero()) {}

void Band::clear() {
  std::fill(data_.begin(), data_.end(), Pack::zero());
}

void Band::factor(const Band& base, std::span<const double> extra, int first, int mark) {
  const auto row_packs = stride_ / kLanes;
  const auto rows = [&](int i) { return static_cast<std::ptrdiff_t>(static_cast<std::size_t>(i) * row_packs); };
  const int kept = first == 0 ? 0 : std::min(size_, first + width_ + 1);
  if (kept > 0) std::copy(marked_.begin(), marked_.begin() + rows(kept - first), data_.begin() + rows(first));
  std::copy(base.data_.begin() + rows(kept), base.data_.end(), data_.begin() + rows(kept));
  eliminate(extra, first, first == 0 ? mark : size_);
}

void Band::eliminate(std::span<const double> extra, int first, int mark) {
  const auto row_packs = stride_ / kLanes;
  double* const pivot = scalars(pivot_);  // the pivot row followed by zeros, so that shifted loads stay in bounds
  for (int i = first; i < size_; ++i) {
    Pack* const own = &data_[static_cast<std::size_t>(i) * row_packs];
    if (i == mark) {
      const int last = std::min(size_, mark + width_ + 1);
      marked_.assign(own, &data_[0] + static_cast<std::size_t>(last) * row_packs);
    }
    std::copy(own, own + row_packs, pivot_.begin());
    if (!extra.empty()) pivot[0] += extra[static_cast<std::size_t>(i)];
    const double inverse = 1.0 / pivot[0];
    const int reach = std::min(width_, size_ - 1 - i);
    for (int r = 1; r <= reach; ++r) {
      const double l = pivot[r] * inverse;
      if (l == 0.0) continue;
      Pack* const target = &data_[static_cast<std::size_t>(i + r) * row_packs];
      const std::size_t used = packs(width_ + 1 - r);
      for (std::size_t c = 0; c < used; ++c) target[c] -= l * Pack::load(pivot + r + c * kLanes);
    }
    for (std::size_t c = 0; c < row_packs; ++c) own[c] = inverse * own[c];
    scalars(data_)[static_cast<std::size_t>(i) * stride_] = inverse;
  }
}

void Band::forward_from(int first, double* x) const {
  for (int i = first; i < size_; ++i)
    for (int r = 1; r <= std::min(width_, size_ - 1 - i); ++r) x[i + r] -= row(i)[r] * x[i];
}

// The unknowns that row i still changes, x[i] .. x[i + 8 n - 1], stay in registers and move on by one place a row.
template <std::size_t n>
void Band::forward(double* x) const {
  constexpr int length = kLanes * static_cast<int>(n);
  const int whole = size_ - length;  // rows whose window ends before x does
  if (whole <= 0) return forward_from(0, x);
  const Pack* own = data_.data();
  std::array<Pack, n> window;
  for (std::size_t c = 0; c < n; ++c) window[c] = Pack::load(x + kLanes * c);
  for (int i = 0; i < whole; ++i, own += n) {
    x[i] = window[0][0];
    const double now = x[i];
    for (std::size_t c = 0; c < n; ++c) window[c] -= now * own[c];
    for (std::size_t c = 0; c + 1 < n; ++c) window[c] = next(window[c], window[c + 1]);
    window[n - 1] = next(window[n - 1], Pack::fill(x[i + length]));
  }
  for (std::size_t c = 0; c < n; ++c) std::memcpy(x + whole + kLanes * static_cast<int>(c), &window[c], sizeof(Pack));
  forward_from(whole, x);
}

void Band::solve(std::span<double> x) const {
  double* const at = x.data();
  switch (stride_ / kLanes) {
    case 1:
      forward<1>(at);
      break;
    case 2:
      forward<2>(at);
      break;
    case 3:
      forward<3>(at);
      break;
    case 4:
      forward<4>(at);
      break;
    case 5:
      forward<5>(at);
      break;
    default:
      forward_from(0, at);
  }
  // Only the product with the unknown found just before waits for it.
  for (int i = size_ - 1; i >= 0; --i) {
    const double* entry = row(i);
    const int reach = std::min(width_, size_ - 1 - i);
    double even = entry[0] * at[i], odd = 0.0, third = 0.0, fourth = 0.0;
    int r = reach;
    for (; r > 4; r -= 4) {
      even -= entry[r] * at[i + r];
      odd -= entry[r - 1] * at[i + r - 1];
      third -= entry[r - 2] * at[i + r - 2];
      fourth -= entry[r - 3] * at[i + r - 3];
    }
    for (; r > 1; --r) odd -= entry[r] * at[i + r];
    at[i] = (even + third) + (odd + fourth);
    if (reach > 0) at[i] -= entry[1] * at[i + 1];
  }
}

// Both sweeps gather, the farthest entries first: only the last product waits for the unknown found just before.
void Band::solve(std::span<Quad> x) const {
  Quad* const at = x.data();
  const double* const l = scalars(data_);
  const auto next = static_cast<std::ptrdiff_t>(stride_) - 1;  // from L(i, i - r) in row i - r to L(i, i - r + 1)
  for (int i = 1; i < size_; ++i) {
    const int reach = std::min(width_, i);
    const double* entry = l + static_cast<std::ptrdiff_t>(i - reach) * (next + 1) + reach;
    Quad even = at[i], odd = Quad::zero();
    int r = reach;
    for (; r > 2; r -= 2, entry += 2 * next) {
      odd -= entry[0] * at[i - r];
      even -= entry[next] * at[i - r + 1];
    }
    if (r == 2) {
      odd -= entry[0] * at[i - 2];
      entry += next;
    }
    at[i] = (even + odd) - entry[0] * at[i - 1];
  }
  for (int i = size_ - 1; i >= 0; --i) {
    const double* entry = row(i);
    int r = std::min(width_, size_ - 1 - i);
    Quad even = entry[0] * at[i], odd = Quad::zero();
    for (; r > 2; r -= 2) {
      odd -= entry[r] * at[i + r];
      even -= entry[r - 1] * at[i + r - 1];
    }
    if (r == 2) odd -= entry[2] * at[i + 2];
    at[i] = even + odd;
    if (r > 0) at[i] -= entry[1] * at[i + 1];
  }
}

}  // namespace whirl::film
