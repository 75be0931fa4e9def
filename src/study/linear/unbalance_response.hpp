#pragma once
// Linear response to unbalance over speed, about the equilibrium at each speed.

#include <optional>

#include "whirl/study/study.hpp"

namespace whirl::study {

struct UnbalanceResponseOptions {
  std::string name;
  std::vector<std::string> unbalance;             ///< names of the machine's unbalances, applied together
  deck::Range range;                              ///< of speed [rad/s]
  int points = 200;                               ///< speeds in the range, evenly spaced with both ends
  std::vector<int> nodes;                         ///< nodes to report; bearings and unbalance planes if empty
  std::optional<deck::Quantity> operating_speed;  ///< [rad/s], where amplitudes are reported
  std::optional<deck::Range> operating;           ///< range of speeds [rad/s], for the separation margins
  bool refine = true;                             ///< add speeds at peaks and at resonances between the speeds
};
void describe(deck::Description<UnbalanceResponseOptions>& d);

class UnbalanceResponse final : public StudyWith<UnbalanceResponseOptions, "unbalance_response"> {
public:
  [[nodiscard]] bool takes_hysteresis() const override { return true; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
