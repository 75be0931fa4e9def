#pragma once
// Elevations of bearings that give zero bending moments and wanted loads on rigid supports.

#include <map>

#include "whirl/study/study.hpp"

namespace whirl::study {

struct AlignmentOptions {
  std::string name;
  std::vector<int> zero_moment;         ///< nodes (1-based) without bending moment
  std::map<std::string, double> loads;  ///< wanted load by bearing, positive down [N]
  std::vector<std::string> adjust;      ///< bearings whose elevation is sought
};
void describe(deck::Description<AlignmentOptions>& d);

class Alignment final : public StudyWith<AlignmentOptions, "alignment"> {
public:
  [[nodiscard]] bool takes_hysteresis() const override { return true; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
