#include "film/sheet/groove.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "whirl/core/error.hpp"

namespace whirl::film {

namespace {

// First and last node of a groove, not yet wrapped.
std::pair<int, int> nodes_of(int n, const Groove& g, double start) {
  const double step = 2.0 * std::numbers::pi / n;
  const double middle = (g.angle - start) / step, half = 0.5 * g.width / step;
  return {static_cast<int>(std::lround(middle - half)), static_cast<int>(std::lround(middle + half))};
}

}  // namespace

std::vector<bool> grooved(int n, const std::vector<Groove>& grooves, double start) {
  std::vector<bool> in(static_cast<std::size_t>(n), false);
  for (const Groove& g : grooves) {
    const auto [first, last] = nodes_of(n, g, start);
    if (last - first >= n - 1) throw core::InputError("film: a groove leaves nothing of the bearing");
    for (int k = first; k <= last; ++k) in[static_cast<std::size_t>((k % n + n) % n)] = true;
  }
  if (std::find(in.begin(), in.end(), false) == in.end())
    throw core::InputError("film: the grooves leave nothing of the bearing");
  return in;
}

std::vector<double> pressures_in_grooves(int n, const std::vector<Groove>& grooves, double start) {
  std::vector<double> p(static_cast<std::size_t>(n), 0.0);
  for (const Groove& g : grooves) {
    const auto [first, last] = nodes_of(n, g, start);
    for (int k = first; k <= last; ++k) p[static_cast<std::size_t>((k % n + n) % n)] = g.pressure;
  }
  return p;
}

}  // namespace whirl::film
