#pragma once
// Equilibria over a parameter, with folds and Hopf bifurcations located.

#include "study/parameter.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

struct EquilibriumBranchOptions {
  std::string name;
  Parameter parameter;
  std::optional<deck::Quantity> speed;  ///< [rad/s], where the parameter is not the speed
  int max_points = 500;
  double picture_tolerance = default_picture_tolerance;
  std::vector<Event> detect{Event::hopf, Event::fold};
};
void describe(deck::Description<EquilibriumBranchOptions>& d);

class EquilibriumBranch final : public StudyWith<EquilibriumBranchOptions, "equilibrium_branch"> {
public:
  [[nodiscard]] bool needs_rotor() const override { return false; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] bool may_add(std::string_view other) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
  [[nodiscard]] std::vector<std::unique_ptr<Study>> further(const io::Group& result) const override;
};

}  // namespace whirl::study
