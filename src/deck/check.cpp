#include <fmt/core.h>

#include <cmath>

#include "whirl/deck/description.hpp"

namespace whirl::deck {

bool Check::holds(double v) const {
  return (min_open ? v > min : v >= min) && (max_open ? v < max : v <= max);
}

std::string Check::text() const {
  const bool low = std::isfinite(min), high = std::isfinite(max);
  if (low && high && (min_open || max_open))
    return fmt::format("{} {} and {} {}", min_open ? "above" : "at least", write_number(min),
                       max_open ? "below" : "at most", write_number(max));
  if (low && high) return fmt::format("between {} and {}", write_number(min), write_number(max));
  if (low && min == 0 && min_open) return "positive";
  if (low) return fmt::format("{} {}", min_open ? "above" : "at least", write_number(min));
  if (high) return fmt::format("{} {}", max_open ? "below" : "at most", write_number(max));
  return {};
}

}  // namespace whirl::deck
