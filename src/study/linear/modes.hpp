#pragma once
// Eigenvalues of the machine over speed.

#include <optional>

#include "whirl/study/study.hpp"

namespace whirl::study {

struct ModesOptions {
  /// What holds the journals: the linearised films, a rigid pin, or nothing.
  enum class Supports { films, pinned, free };
  /// What moves: the shaft across its axis, or about it and along it, each by itself.
  enum class Motion { bending, torsion, axial };
  std::string name;
  Supports supports = Supports::films;
  Motion motion = Motion::bending;
  std::vector<int> held;                  ///< 1-based nodes that do not turn or move along, of torsion and axial motion
  std::optional<deck::Range> range;       ///< of speed [rad/s]
  int points = 40;                        ///< speeds in the range, evenly spaced with both ends
  std::vector<deck::Quantity> speeds;     ///< [rad/s], instead of a range
  int count = 14;                         ///< modes to find, those of lowest frequency
  std::optional<double> max_frequency;    ///< |imaginary part| up to which modes are reported [rad/s]
  std::optional<deck::Range> operating;   ///< [rad/s] from which separation margins are counted
  bool condition = false;                 ///< condition numbers of the eigenvalues, by left vectors
  std::vector<deck::Quantity> shapes_at;  ///< speeds at which shapes are kept [rad/s]; the last one if empty

  /// Those of `shapes_at` in rad/s, or the last of all speeds.
  [[nodiscard]] std::vector<double> all_shape_speeds() const;
  /// All speeds in rad/s, and the unit in which they were written.
  [[nodiscard]] std::vector<double> all_speeds() const;
  [[nodiscard]] std::string unit() const;
};
[[nodiscard]] std::span<const deck::Name<ModesOptions::Supports>> names(ModesOptions::Supports);
[[nodiscard]] std::span<const deck::Name<ModesOptions::Motion>> names(ModesOptions::Motion);
void describe(deck::Description<ModesOptions>& d);

class Modes final : public StudyWith<ModesOptions, "modes"> {
public:
  [[nodiscard]] bool takes_hysteresis() const override { return true; }
  [[nodiscard]] bool needs_bearings() const override {
    return options.motion == ModesOptions::Motion::bending && options.supports == ModesOptions::Supports::films;
  }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;

private:
  void validate_line(const system::Machine& machine, const deck::Report& report) const;
};

/// Whether these modes are of the shaft alone.
[[nodiscard]] bool of_shaft_alone(const ModesOptions& options);

/// The frequencies with their bars, and the shapes of torsion and axial motion. Collective.
[[nodiscard]] StudyResult modes_of_shaft_alone(Context& context, const ModesOptions& options);

}  // namespace whirl::study
