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
/// Richardson's extrapolation with the order that the last three values show and a safety factor of 1.25 if it lies
/// between 1/2 and `theory`, that of the scheme. A higher one is chance: the last two meshes agree too well. Then the
/// order is that of theory and the error no less than the difference before foretells with it. Below 1/2, with two
/// values, where they waver, or where forces have kinks, the factor is 3; below 1/2 the order is 1/2.
/// Source: Roache (1994).
[[nodiscard]] MeshLimit mesh_limit(const std::vector<double>& values, double theory = 2, bool kinks = false);

class MeshConvergence final : public StudyWith<MeshConvergenceOptions> {
public:
  static constexpr std::string_view key = "mesh_convergence";
  [[nodiscard]] std::string_view kind() const override { return key; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  void validate_among(std::span<const std::unique_ptr<Study>> before, const deck::Report& report) const override;
  [[nodiscard]] std::string starts_from() const override { return options.of; }
  [[nodiscard]] StudyResult run(Context& context) override;
};

}  // namespace whirl::study
