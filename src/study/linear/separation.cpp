#include "whirl/study/linear/separation.hpp"

#include <cmath>
#include <limits>

namespace whirl::study {

Separation separation(double speed, double amplification, double from, double to) {
  constexpr double damped = 2.5;
  const bool above = speed > to || (speed >= from && to - speed < speed - from);
  Separation s;
  if (speed < from) s.actual = (from - speed) / from;
  if (speed > to) s.actual = (speed - to) / to;
  if (!std::isfinite(amplification))
    s.required = std::numeric_limits<double>::quiet_NaN();
  else if (amplification >= damped)
    s.required = (above ? 0.10 : 0.0) + 0.17 * (1 - 1 / (amplification - 1.5));
  return s;
}

}  // namespace whirl::study
