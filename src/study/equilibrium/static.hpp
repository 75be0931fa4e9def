#pragma once
// Where the machine sits: equilibrium at one speed.

#include "whirl/study/study.hpp"

namespace whirl::study {

struct StaticOptions {
  std::string name;
  deck::Quantity speed;  ///< [rad/s], and the unit of the deck
  bool fields = true;    ///< write pressure and thickness of every film
};
void describe(deck::Description<StaticOptions>& d);

class Static final : public StudyWith<StaticOptions, "static"> {
public:
  [[nodiscard]] bool takes_hysteresis() const override { return true; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
