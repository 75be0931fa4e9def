#pragma once
// Undamped critical speeds of the shaft over the stiffness of its bearings.

#include "whirl/study/study.hpp"

namespace whirl::study {

struct CriticalSpeedMapOptions {
  std::string name;
  deck::Range stiffness;  ///< of each bearing [N/m]
  int points = 41;        ///< in the range, evenly spaced in its logarithm, with both ends
  int count = 4;          ///< critical speeds of each direction of whirl, the lowest
};
void describe(deck::Description<CriticalSpeedMapOptions>& d);

class CriticalSpeedMap final : public StudyWith<CriticalSpeedMapOptions, "critical_speed_map"> {
public:
  [[nodiscard]] bool takes_hysteresis() const override { return true; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
