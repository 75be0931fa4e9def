#pragma once
// Where a study found that a machine becomes stable or ceases to be.

#include <optional>
#include <string>
#include <vector>

#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Two speeds nearer than this part of them are one.
constexpr double same_speed = 1e-6;

/// A speed at which a machine becomes stable or ceases to be, with its bar [rad/s].
struct SpeedLimit {
  double at, error;
  bool stable_below;
};

/// Those between the stretches over the speed that a branch or modes found (`StudySummary::ranges`).
[[nodiscard]] std::vector<SpeedLimit> limits_of(const io::StudySummary& summary);

/// What stands between `head` and `tail` in a name, "B3" of "bearing.B3.min_thickness"; nothing if the name is another.
[[nodiscard]] std::optional<std::string> between(const std::string& name, const std::string& head,
                                                 const std::string& tail);

}  // namespace whirl::study
