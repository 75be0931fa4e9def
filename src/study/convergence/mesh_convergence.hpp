#pragma once
// Bifurcations of a branch of cycles on finer and finer film meshes: observed order, limit, error.

#include <limits>

#include "whirl/study/study.hpp"

namespace whirl::study {

struct MeshConvergenceOptions {
  std::string name;
  std::string of;                 ///< an earlier cycle_branch of the deck, or a branch born at one of its flips
  std::vector<int> bifurcations;  ///< which of its bifurcations, 1-based, in the order of summary.json; all if empty
  int doublings = 2;              ///< of the film meshes, in both directions
};
void describe(deck::Description<MeshConvergenceOptions>& d);

/// Limit of a value on meshes that are doubled each time, the last the finest, and its estimated error.
struct MeshLimit {
  double limit = std::numeric_limits<double>::quiet_NaN(), error = limit;
  double order = limit;  ///< shown by the last three values
};
/// Richardson's extrapolation with the observed order of the last three values.
/// - An order between 1/2 and `theory` (the order of the scheme) has the safety factor 1.25.
/// - A higher order is chance: the last two meshes agree too well. The order is then `theory`, and the error is at
///   least what the difference before predicts with it.
/// - The factor is 3 for an order below 1/2 (taken as 1/2), with two values, where they waver, or for forces with
/// kinks. Source: Roache (1994).
[[nodiscard]] MeshLimit mesh_limit(const std::vector<double>& values, double theory = 2, bool kinks = false);

class MeshConvergence final : public StudyWith<MeshConvergenceOptions, "mesh_convergence"> {
public:
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  void validate_among(std::span<const std::unique_ptr<Study>> before, const deck::Report& report) const override;
  [[nodiscard]] std::string starts_from() const override { return options.of; }
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
