#pragma once
// A motion in time: orbit, Poincare points, spectrum, Lyapunov exponents, and what kind of motion it is.

#include <array>
#include <optional>

#include "study/motion/assessment.hpp"
#include "study/motion/forces.hpp"
#include "whirl/transient/steps/scheme.hpp"

namespace whirl::study {

/// Where a motion begins.
struct MotionStart {
  enum class From { equilibrium, cycle, centre };
  From from = From::equilibrium;
  std::array<double, 2> offset{};  ///< of every journal in x and y, per clearance
};
[[nodiscard]] std::span<const deck::Name<MotionStart::From>> names(MotionStart::From);
void describe(deck::Description<MotionStart>& d);

/// Reports a scheme that the machine's films do not allow, or external forces if it is `forced` by some.
void check_scheme(const std::string& key, const transient::Scheme& scheme, bool forced, const system::Machine& machine,
                  const deck::Report& report);

struct MotionOptions {
  std::string name;
  std::vector<std::string> unbalance;  ///< names of the machine's unbalances, applied together; none: balanced
  deck::Quantity speed;                ///< [rad/s]
  std::vector<ForceOptions> forces;    ///< external, over the time since the motion began
  MotionStart start;
  int discard = 200;      ///< revolutions before anything is recorded
  int revolutions = 400;  ///< recorded
  int samples = 64;       ///< per revolution
  double tolerance = 1e-8;
  transient::SchemeOptions integrator;
  int exponents = 2;  ///< Lyapunov exponents, the largest
  int max_period = 8;
  double return_tolerance = 1e-4;
  transient::Window window = transient::Window::hann;
  int orbit = 20;  ///< revolutions whose orbit is stored, the last ones
  std::optional<SectionOptions> section;
  std::optional<OrderOptions> orders;
  std::optional<WaterfallOptions> waterfall;
  bool checkpoint = true;
};
void describe(deck::Description<MotionOptions>& d);

class Motion final : public StudyWith<MotionOptions, "motion"> {
public:
  [[nodiscard]] bool needs_rotor() const override { return false; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
