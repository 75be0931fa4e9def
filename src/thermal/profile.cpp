#include "thermal/profile.hpp"

namespace whirl::thermal {

void Profile::set(double h, const double* mu) {
  const std::size_t l = by_drag.size();
  const double d = layer = h / static_cast<double>(l);
  double f0 = 0, f1 = 0;
  for (std::size_t k = 0; k < l; ++k) {
    const double low = d * static_cast<double>(k), high = low + d;
    const double step0 = d / mu[k], step1 = (high * high - low * low) / (2 * mu[k]);
    // int over the layer of int_0^s ds/mu and of int_0^s s ds/mu
    by_drag[k] = d * f0 + d * d / (2 * mu[k]);
    by_pressure[k] = d * f1 + ((high * high * high - low * low * low) / 3 - low * low * d) / (2 * mu[k]);
    drag[k] = f0;
    pressure[k] = f1;
    f0 += step0;
    f1 += step1;
  }
  drag[l] = f0;
  pressure[l] = f1;
  neutral = f1 / f0;
  pull = 1 / f0;
  for (std::size_t k = 0; k <= l; ++k) {
    pressure[k] -= neutral * drag[k];
    drag[k] *= pull;
  }
  for (std::size_t k = 0; k < l; ++k) {
    by_pressure[k] -= neutral * by_drag[k];
    by_drag[k] *= pull;
  }
  pressure[l] = 0;
  drag[l] = 1;
}

Profile::Middle Profile::middle() const {
  const std::size_t l = by_drag.size(), k = l / 2;
  if (l % 2 == 0) return {pressure[k], drag[k]};
  const double fluidity = (drag[k + 1] - drag[k]) / (pull * layer);  // 1/mu, the curvature of `pressure`
  return {0.5 * (pressure[k] + pressure[k + 1]) - layer * layer / 8 * fluidity, 0.5 * (drag[k] + drag[k + 1])};
}

}  // namespace whirl::thermal
