#include "verdict.hpp"

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
  for (const bool loses : {true, false}) {
    if (!loses && rising) break;
    for (std::size_t k = 0; k < events.size(); ++k)
      if (events[k].is_border && events[k].loses == loses) return static_cast<int>(k);
  }
  return -1;
}

}  // namespace whirl::study
