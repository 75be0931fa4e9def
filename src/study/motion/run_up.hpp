#pragma once
// A rotor whose speed rises or falls evenly: how large it becomes on the way through its resonances.

#include <optional>

#include "study/motion/motion.hpp"

namespace whirl::study {

struct RunUpOptions {
  std::string name;
  std::vector<std::string> unbalance;          ///< names of the machine's unbalances, applied together
  deck::Range range;                           ///< of speed [rad/s]; from the larger to the smaller one: coast-down
  std::optional<deck::Quantity> acceleration;  ///< its size [rad/s^2]
  std::optional<deck::Quantity> duration;      ///< [s], instead
  std::vector<ForceOptions> forces;            ///< external, over the time since the run-up began
  MotionStart start;
  std::vector<int> nodes;  ///< of the shaft, reported beside the bearings
  int samples = 64;        ///< per revolution, at equal angles
  double tolerance = 1e-7;
  transient::SchemeOptions integrator;
  std::optional<OrderOptions> orders;
  std::optional<WaterfallOptions> waterfall;
  bool checkpoint = true;
};
/// Revolutions of the shaft on the way.
[[nodiscard]] double revolutions(const RunUpOptions& options);
void describe(deck::Description<RunUpOptions>& d);

class RunUp final : public StudyWith<RunUpOptions, "run_up"> {
public:
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
