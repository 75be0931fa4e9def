#include "whirl/core/curve.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::core {
namespace {

// Slope at a row between intervals of lengths h and slopes d, zero where these turn: the curve does not overshoot.
double slope_between(double h0, double h1, double d0, double d1) {
  if (!(d0 * d1 > 0)) return 0;
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

// The same at an end, of a parabola through three rows.
double slope_at_end(double h0, double h1, double d0, double d1) {
  const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (!(slope * d0 > 0)) return 0;
  return d0 * d1 <= 0 && std::abs(slope) > 3 * std::abs(d0) ? 3 * d0 : slope;
}

}  // namespace

Curve::Curve(std::vector<double> abscissae, std::vector<double> values, Between between)
    : abscissae_(std::move(abscissae)), values_(std::move(values)) {
  const std::size_t n = abscissae_.size();
  for (std::size_t k = 1; k < n; ++k)
    if (!(abscissae_[k] > abscissae_[k - 1])) throw InputError("the abscissae of a table rise");
  if (n == 0) return;
  columns_ = values_.size() / n;
  require(columns_ * n == values_.size(), "a table has as many values in each row");
  if (between == Between::linear) return;
  slopes_.assign(values_.size(), 0.0);
  const auto h = [&](std::size_t k) { return abscissae_[k + 1] - abscissae_[k]; };
  for (std::size_t e = 0; e < columns_ && n > 1; ++e) {
    const auto d = [&](std::size_t k) { return (values_[(k + 1) * columns_ + e] - values_[k * columns_ + e]) / h(k); };
    const auto slope = [&](std::size_t k) -> double& { return slopes_[k * columns_ + e]; };
    if (n == 2) {
      slope(0) = slope(1) = d(0);
      continue;
    }
    slope(0) = slope_at_end(h(0), h(1), d(0), d(1));
    slope(n - 1) = slope_at_end(h(n - 2), h(n - 3), d(n - 2), d(n - 3));
    for (std::size_t k = 1; k + 1 < n; ++k) slope(k) = slope_between(h(k - 1), h(k), d(k - 1), d(k));
  }
}

void Curve::at(double x, std::span<double> value, std::span<double> slope) const {
  require(!empty() && value.size() == columns_ && slope.size() == columns_, "a table with rows, asked for its columns");
  const std::size_t n = abscissae_.size();
  if (n == 1 || !(x > first() && x < last())) {
    const std::size_t end = x >= last() ? n - 1 : 0;
    std::copy_n(values_.begin() + static_cast<std::ptrdiff_t>(end * columns_), columns_, value.begin());
    std::fill(slope.begin(), slope.end(), 0.0);
    // At the ends themselves the curve goes on inwards.
    if (n == 1 || (x != first() && x != last())) return;
  }
  const auto above = std::upper_bound(abscissae_.begin() + 1, abscissae_.end() - 1, x);
  const auto k = static_cast<std::size_t>(above - abscissae_.begin()) - 1;
  const double h = abscissae_[k + 1] - abscissae_[k], t = (x - abscissae_[k]) / h, u = 1 - t;
  for (std::size_t e = 0; e < columns_; ++e) {
    const double here = values_[k * columns_ + e], rise = values_[(k + 1) * columns_ + e] - here;
    if (slopes_.empty()) {
      value[e] = here + t * rise;
      slope[e] = rise / h;
      continue;
    }
    const double first_slope = slopes_[k * columns_ + e], last_slope = slopes_[(k + 1) * columns_ + e];
    value[e] = here + rise * t * t * (3 - 2 * t) + h * t * u * (first_slope * u - last_slope * t);
    slope[e] = rise * 6 * t * u / h + first_slope * u * (1 - 3 * t) - last_slope * t * (2 - 3 * t);
  }
}

}  // namespace whirl::core
