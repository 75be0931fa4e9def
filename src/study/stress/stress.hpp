#pragma once
// How far the weight, the bearings and unbalance bend a shaft, and how much that leaves of its strength.

#include <optional>

#include "whirl/study/study.hpp"

namespace whirl::study {

struct StressOptions {
  std::string name;
  deck::Quantity speed;                ///< [rad/s], and the unit of the deck
  std::vector<std::string> unbalance;  ///< applied together; empty: what stands still alone
  std::optional<double> endurance;     ///< amplitude of stress that the shaft bears for ever, notches included [Pa]
  std::optional<double> strength;      ///< tensile strength [Pa]
};
void describe(deck::Description<StressOptions>& d);

class Stress final : public StudyWith<StressOptions, "stress"> {
public:
  [[nodiscard]] bool takes_hysteresis() const override { return true; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
