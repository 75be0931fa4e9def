#include "whirl/transient/analysis/window.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace whirl::transient {
namespace {}  // namespace

std::span<const deck::Name<Window>> names(Window) {
  using enum Window;
  static constexpr deck::Name<Window> table[] = {
      {none, "none", "exact for motions that repeat themselves within the record"},
      {hann, "hann", "Hann's: leaks little where tones lie between the lines; lobes of 2 lines to each side"},
      {hamming, "hamming", "Hamming's: the nearest side lobes lower than Hann's (-43 dB), far ones higher"},
      {blackman_harris, "blackman_harris",
       "four terms: side lobes below -92 dB, for small tones beside large ones; 4 lines"},
      {flat_top, "flat_top", "amplitudes right within 0.1 % wherever tones lie, frequencies least; 5 lines"}};
  return table;
}

std::span<const double> coefficients(Window window) {
  static constexpr double none[] = {1.0}, hann[] = {0.5, 0.5}, hamming[] = {0.54, 0.46},
                          blackman_harris[] = {0.35875, 0.48829, 0.14128, 0.01168},
                          flat_top[] = {1.0, 1.933, 1.286, 0.388, 0.0322};
  switch (window) {
    case Window::none:
      return none;
    case Window::hann:
      return hann;
    case Window::hamming:
      return hamming;
    case Window::blackman_harris:
      return blackman_harris;
    case Window::flat_top:
      break;
  }
  return flat_top;
}

std::vector<double> weights(Window window, std::size_t n) {
  const auto a = coefficients(window);
  std::vector<double> w(n, 0.0);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j < a.size(); ++j)
      w[k] += (j % 2 == 0 ? a[j] : -a[j]) *
              std::cos(2 * std::numbers::pi * static_cast<double>(j) * static_cast<double>(k) / static_cast<double>(n));
  return w;
}

double response(Window window, double offset) {
  const auto a = coefficients(window);
  const double x = std::abs(offset), line = std::round(x), from_line = x - line;
  const auto nearest = static_cast<std::size_t>(line);
  // On a line only one term is left.
  if (from_line == 0) return nearest == 0 ? 1 : nearest < a.size() ? a[nearest] / (2 * a[0]) : 0;
  double sum = a[0] / x;
  for (std::size_t j = 1; j < a.size(); ++j) {
    const double d = j == nearest ? from_line : x - static_cast<double>(j);
    sum += (j % 2 == 0 ? a[j] : -a[j]) * x / (d * (x + static_cast<double>(j)));
  }
  return std::abs(std::sin(std::numbers::pi * from_line) / std::numbers::pi * sum) / a[0];
}

double offset_of(Window window, double ratio) {
  const auto at = [&](double x) { return response(window, 1 - x) / response(window, x); };
  double low = 0, high = 0.5;
  if (ratio <= at(low)) return low;
  if (ratio >= 1) return high;
  while (high - low > 1e-15) {
    const double middle = (low + high) / 2;
    if (middle <= low || middle >= high) break;
    (at(middle) < ratio ? low : high) = middle;
  }
  return (low + high) / 2;
}

WindowFacts facts(Window window) {
  const auto a = coefficients(window);
  double squares = a[0] * a[0];
  for (std::size_t j = 1; j < a.size(); ++j) squares += a[j] * a[j] / 2;
  return {static_cast<double>(a.size()), squares / (a[0] * a[0]), 1 - response(window, 0.5)};
}

}  // namespace whirl::transient
