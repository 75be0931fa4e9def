#include "thermal/profile.hpp"

namespace whirl::thermal {

void Profile::set(double h, const double* mu) {
  const std::size_t l = by_drag.size();
  const double d = h / static_cast<double>(l);
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

}  // namespace whirl::thermal
