#pragma once
// Numbers and places that are evenly spaced, both ends among them.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace whirl::study {

/// `count` >= 2 numbers with equal differences.
[[nodiscard]] inline std::vector<double> evenly(double from, double to, int count) {
  std::vector<double> out;
  for (int k = 0; k < count; ++k) out.push_back(k + 1 < count ? from + (to - from) * k / (count - 1) : to);
  return out;
}

/// `count` >= 2 numbers with equal ratios.
[[nodiscard]] inline std::vector<double> by_ratios(double from, double to, int count) {
  std::vector<double> out;
  for (int k = 0; k < count; ++k) out.push_back(from * std::pow(to / from, static_cast<double>(k) / (count - 1)));
  return out;
}

/// At most `most` >= 2 of the places 0 to n - 1.
[[nodiscard]] inline std::vector<std::size_t> few_of(std::size_t n, std::size_t most) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < std::min(n, most); ++k) out.push_back(n <= most ? k : k * (n - 1) / (most - 1));
  return out;
}

}  // namespace whirl::study
