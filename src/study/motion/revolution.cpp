#include "study/motion/revolution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "whirl/core/error.hpp"

namespace whirl::study {

double Revolution::extreme(std::size_t place, std::size_t direction, double sign) const {
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& s : samples[place]) most = std::max(most, sign * s[direction]);
  return sign * most;
}

double Revolution::distance(std::size_t place, const std::array<double, 2>& centre) const {
  double most = 0;
  for (const auto& s : samples[place]) most = std::max(most, std::hypot(s[0] - centre[0], s[1] - centre[1]));
  return most;
}

void NearRevolutions::add(Revolution next) {
  all_.push_back(std::move(next));
}

long NearRevolutions::ready() const {
  return added() < static_cast<long>(width) ? 0 : added() - static_cast<long>(width / 2);
}

const Revolution& NearRevolutions::at(long revolution) const {
  return all_.at(static_cast<std::size_t>(revolution - first_));
}

long NearRevolutions::window_begin(long revolution) const {
  const long n = static_cast<long>(width);
  return std::clamp(revolution - n / 2, 0L, std::max(0L, added() - n));
}

std::array<double, 2> NearRevolutions::centre(long revolution, std::size_t place) const {
  const long begin = window_begin(revolution), end = std::min(begin + static_cast<long>(width), added());
  core::require(begin >= first_, "the neighbours of a revolution were forgotten");
  const std::size_t per = all_.front().samples[place].size();
  const double all = static_cast<double>(per) * static_cast<double>(end - begin);
  std::array<double, 2> sum{};
  double weights = 0;
  std::size_t j = 0;
  for (long k = begin; k < end; ++k)
    for (const auto& s : at(k).samples[place]) {
      const double w = 1 - std::cos(2 * std::numbers::pi * (static_cast<double>(j++) + 0.5) / all);
      weights += w;
      for (std::size_t d = 0; d < 2; ++d) sum[d] += w * s[d];
    }
  return {sum[0] / weights, sum[1] / weights};
}

void NearRevolutions::forget_before(long revolution) {
  // Those that end the record use a window that begins earlier.
  const long needed =
      std::max(0L, std::min(revolution - static_cast<long>(width / 2), added() - static_cast<long>(width)));
  if (needed <= first_) return;
  all_.erase(all_.begin(), all_.begin() + (needed - first_));
  first_ = needed;
}

}  // namespace whirl::study
