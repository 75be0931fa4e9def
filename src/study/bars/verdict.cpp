#include "study/bars/verdict.hpp"

namespace whirl::study {

const char* name_of(StabilityClass c) {
  static constexpr const char* names[] = {"stable", "undamped", "unstable"};
  return names[static_cast<std::size_t>(c)];
}

StabilityClass class_of(const solve::Stability& s) {
  if (s.unstable() > 0) return StabilityClass::unstable;
  return s.neutral > 0 ? StabilityClass::undamped : StabilityClass::stable;
}

void BranchVerdict::add(StabilityClass c) {
  if (empty_) first_ = c;
  empty_ = false;
  met_[static_cast<std::size_t>(c)] = true;
}

std::string BranchVerdict::text() const {
  if (empty_) return {};
  if (met_[0] + met_[1] + met_[2] == 1) return std::string(name_of(first_)) + " throughout";
  if (first_ == StabilityClass::unstable) return "unstable from its start";
  if (!met_[static_cast<std::size_t>(StabilityClass::unstable)]) return "stable or undamped";
  return first_ == StabilityClass::stable ? "loses stability" : "undamped, then unstable";
}

int threshold_among(const std::vector<BorderEvent>& events, bool rising) {
  int found = -1;
  for (std::size_t k = 0; k < events.size(); ++k) {
    if (!events[k].is_border) continue;
    // On the way down the last one at which stability is regained is the first at which it is lost on the way up.
    if (events[k].loses == rising) {
      found = static_cast<int>(k);
      if (rising) return found;
    }
  }
  for (std::size_t k = 0; found < 0 && !rising && k < events.size(); ++k)
    if (events[k].is_border) found = static_cast<int>(k);
  return found;
}

}  // namespace whirl::study
