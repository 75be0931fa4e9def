#pragma once
// Frequency response of the machine, linear about its equilibrium: a matrix of transfer functions.

#include <optional>
#include <span>
#include <vector>

#include "whirl/study/study.hpp"

namespace whirl::study {

/// Along which motion of a place a force acts or an output is taken.
enum class Along { x, y, slope_x, slope_y };
[[nodiscard]] std::span<const deck::Name<Along>> names(Along);

/// A force [N] or moment [N m] on a node of the shaft, or between a journal and its pedestal.
struct TransferInput {
  std::optional<int> node;  ///< 1-based
  std::string bearing;      ///< instead of a node
  Along direction = Along::x;
};
void describe(deck::Description<TransferInput>& d);

/// A motion of a node of the shaft, or of a journal relative to its pedestal.
struct TransferOutput {
  enum class Quantity { displacement, velocity, acceleration };
  std::optional<int> node;
  std::string bearing;
  Along direction = Along::x;
  Quantity quantity = Quantity::displacement;
};
[[nodiscard]] std::span<const deck::Name<TransferOutput::Quantity>> names(TransferOutput::Quantity);
void describe(deck::Description<TransferOutput>& d);

/// Stiffness [N/m] and damping [N s/m] at one frequency [rad/s]: force = -k d - b d', first letter the force's.
struct CoefficientsAt {
  double frequency = 0;
  double k_xx = 0, k_xy = 0, k_yx = 0, k_yy = 0;
  double c_xx = 0, c_xy = 0, c_yx = 0, c_yy = 0;
};
void describe(deck::Description<CoefficientsAt>& d);

/// Those of a bearing that the user knows, linear between the frequencies.
struct GivenCoefficients {
  std::string bearing;
  std::vector<CoefficientsAt> table;
};
void describe(deck::Description<GivenCoefficients>& d);
/// Within the table.
[[nodiscard]] CoefficientsAt interpolated(const std::vector<CoefficientsAt>& table, double frequency);

struct FrequencyResponseOptions {
  enum class Spacing { linear, log };
  std::string name;
  deck::Quantity speed;  ///< of the shaft [rad/s]
  deck::Range range;     ///< of the frequency [rad/s]
  int points = 200;
  Spacing spacing = Spacing::linear;
  std::vector<TransferInput> inputs;
  std::vector<TransferOutput> outputs;      ///< displacements of the inputs if empty
  bool coefficients = false;                ///< also by stiffness and damping of the films at each frequency
  std::vector<deck::Quantity> constant_at;  ///< also by those at these frequencies [rad/s]
  std::vector<GivenCoefficients> given;     ///< also with these in place of the films of some bearings
};
[[nodiscard]] std::span<const deck::Name<FrequencyResponseOptions::Spacing>> names(FrequencyResponseOptions::Spacing);
void describe(deck::Description<FrequencyResponseOptions>& d);

class FrequencyResponse final : public StudyWith<FrequencyResponseOptions, "frequency_response"> {
public:
  [[nodiscard]] bool takes_hysteresis() const override { return true; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
