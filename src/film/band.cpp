#include "film/band.hpp"

#include <algorithm>

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

void Band::factor() {
  const auto row_packs = stride_ / kLanes;
  double* const pivot = scalars(pivot_);  // the pivot row followed by zeros, so that shifted loads stay in bounds
  for (int i = 0; i < size_; ++i) {
    Pack* const own = &data_[static_cast<std::size_t>(i) * row_packs];
    std::copy(own, own + row_packs, pivot_.begin());
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

void Band::solve(std::span<Quad> x) const {
  Quad* const at = x.data();
  for (int i = 0; i < size_; ++i) {
    const double* l = row(i);
    const int reach = std::min(width_, size_ - 1 - i);
    const Quad xi = at[i];
    for (int r = 1; r <= reach; ++r) at[i + r] -= l[r] * xi;
  }
  for (int i = size_ - 1; i >= 0; --i) {
    const double* l = row(i);
    const int reach = std::min(width_, size_ - 1 - i);
    Quad even = l[0] * at[i], odd = Quad::zero();
    int r = 1;
    for (; r < reach; r += 2) {
      even -= l[r] * at[i + r];
      odd -= l[r + 1] * at[i + r + 1];
    }
    if (r <= reach) even -= l[r] * at[i + r];
    at[i] = even + odd;
  }
}

}  // namespace whirl::film
