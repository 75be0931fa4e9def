#pragma once
// What a branch as a whole says about stability.

#include <array>
#include <string>
#include <vector>

#include "whirl/io/summary.hpp"
#include "whirl/solve/branch/continuation.hpp"

namespace whirl::study {

/// Stability of one solution: `undamped` where nothing grows and rounding hides whether something decays.
enum class StabilityClass { stable, undamped, unstable };
[[nodiscard]] const char* name_of(StabilityClass c);
[[nodiscard]] StabilityClass class_of(const solve::Stability& stability);

/// The points of a branch one after the other, and the verdict on all of them.
class BranchVerdict {
public:
  void add(StabilityClass c);
  /// `stable throughout`, `undamped throughout`, `unstable throughout`, `loses stability` (the first point is stable),
  /// `unstable from its start` (and stable or undamped somewhere), `undamped, then unstable`, `stable or undamped`;
  /// empty without points.
  [[nodiscard]] std::string text() const;

private:
  bool empty_ = true;
  StabilityClass first_ = StabilityClass::stable;
  std::array<bool, 3> met_{};
};

/// The bifurcation at which a stable branch loses its stability: none else is unstable there, and one more value or
/// pair becomes so along the branch (or, where the branch runs towards falling parameters, ceases to be). Its place
/// among `events`, or -1.
struct BorderEvent {
  bool is_border = false;  ///< nothing else is unstable there
  bool loses = false;      ///< something becomes unstable along the branch
};
[[nodiscard]] int threshold_among(const std::vector<BorderEvent>& events, bool rising);

}  // namespace whirl::study
