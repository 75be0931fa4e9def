#include "film/groove.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "whirl/core/error.hpp"

namespace whirl::film {

std::vector<bool> grooved(int n, const std::vector<Groove>& grooves) {
  std::vector<bool> in(static_cast<std::size_t>(n), false);
  const double step = 2.0 * std::numbers::pi / n;
  for (const Groove& g : grooves) {
    const double middle = (g.angle - 0.5 * std::numbers::pi) / step, half = 0.5 * g.width / step;
    const int first = static_cast<int>(std::lround(middle - half)), last = static_cast<int>(std::lround(middle + half));
    if (last - first >= n - 1) throw core::InputError("film: a groove leaves nothing of the bearing");
    for (int k = first; k <= last; ++k) in[static_cast<std::size_t>((k % n + n) % n)] = true;
  }
  if (std::find(in.begin(), in.end(), false) == in.end())
    throw core::InputError("film: the grooves leave nothing of the bearing");
  return in;
}

}  // namespace whirl::film
