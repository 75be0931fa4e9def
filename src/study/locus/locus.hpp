#pragma once
// Bifurcations in two parameters: a curve of folds, Hopf points, flips or Neimark-Sacker points; or cycles that keep an
// amplitude or a period.

#include <optional>

#include "study/locus/limit.hpp"
#include "study/parameter.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

struct LocusOptions {
  std::string name;
  std::string of;                          ///< an earlier cycle_branch or equilibrium_branch of the deck
  int bifurcation = 1;                     ///< which of its bifurcations, 1-based, in the order of summary.json
  std::optional<LimitOptions> limit;       ///< instead of a bifurcation
  Parameter second;                        ///< the second parameter; the branch's own is the first
  std::optional<deck::Range> first_range;  ///< where the curve may go in the first one; the branch's range if absent
  int max_points = 500;
  double picture_tolerance = default_picture_tolerance;
};
void describe(deck::Description<LocusOptions>& d);

class Locus final : public StudyWith<LocusOptions, "locus"> {
public:
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  void validate_among(std::span<const std::unique_ptr<Study>> before, const deck::Report& report) const override;
  [[nodiscard]] std::string starts_from() const override { return options.of; }
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
