#pragma once
// Whether a rotor in its films answers random forces as its linearisation does: transfer functions and coherence.

#include <optional>

#include "whirl/study/study.hpp"

namespace whirl::study {

struct LinearityOptions {
  std::string name;
  deck::Quantity speed;                ///< [rad/s]
  std::optional<std::string> bearing;  ///< whose journal is excited and watched; the first if neither is given
  std::optional<int> node;             ///< of the shaft, instead
  std::vector<double> levels;          ///< root mean square of each of both forces [N]
  double cutoff = 10e3;                ///< of their low pass [Hz]
  int oversampling = 4;                ///< samples per period of the cut-off frequency
  int seed = 1;
  double settle = 0.1;    ///< time before the record [s]
  double duration = 6;    ///< of the record [s]
  int segments = 91;      ///< that overlap by half
  double highest = 2000;  ///< frequency up to which results go [Hz]
  double probability = 0.95;
  double tolerance = 1e-6;
  bool checkpoint = true;
};
void describe(deck::Description<LinearityOptions>& d);

class Linearity final : public StudyWith<LinearityOptions, "linearity"> {
public:
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
