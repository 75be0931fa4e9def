#pragma once
// What reductions of the shaft cost: eigenvalues, eigenvectors and orbits beside those of the whole shaft.

#include <optional>

#include "whirl/study/study.hpp"

namespace whirl::study {

/// A way to keep some freedoms of a shaft.
enum class ReductionMethod { modal_supported, modal_free, craig_bampton, craig_bampton_state };
[[nodiscard]] std::span<const deck::Name<ReductionMethod>> names(ReductionMethod);

/// Motions from rest under an unbalance that sets in at once.
struct ReductionOrbits {
  std::vector<int> freedoms{10, 20};
  std::vector<std::string> unbalance;
  int node = 0;
  double revolutions = 12;
  int samples = 96;  ///< per revolution
};
void describe(deck::Description<ReductionOrbits>& d);

struct ReductionErrorsOptions {
  std::string name;
  double speed = 0;  ///< [rad/s], also of the complex modes
  std::vector<ReductionMethod> methods{ReductionMethod::modal_supported, ReductionMethod::modal_free,
                                       ReductionMethod::craig_bampton, ReductionMethod::craig_bampton_state};
  std::vector<int> freedoms{10, 12, 14, 16, 20, 24, 28, 32, 40};  ///< of both planes, masters and modes
  std::vector<int> masters;                                       ///< beside the nodes of the bearings
  double support = 0;                                             ///< [N/m]; 0: the mean direct stiffness of the films
  int count = 10;                                                 ///< modes compared
  int maps = 0;                                                   ///< freedoms of the matrices that are kept; 0: none
  std::optional<ReductionOrbits> orbits;
};
void describe(deck::Description<ReductionErrorsOptions>& d);

class ReductionErrors final : public StudyWith<ReductionErrorsOptions, "reduction_errors"> {
public:
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
