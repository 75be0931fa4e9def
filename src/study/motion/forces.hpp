#pragma once
// External forces that a deck lets act on a rotor.

#include <optional>
#include <string>
#include <vector>

#include "whirl/study/study.hpp"
#include "whirl/system/rotor_system.hpp"
#include "whirl/transient/steps/force.hpp"

namespace whirl::study {

/// A force on a node of the shaft, or on the journal of a bearing, as a function of time.
struct ForceOptions {
  enum class Direction { x, y, slope_x, slope_y };
  std::string name;
  std::optional<int> node;             ///< 1-based
  std::optional<std::string> bearing;  ///< instead: the node of its journal
  Direction direction = Direction::x;
  std::optional<double> arm;  ///< of a couple of such forces, in directions slope_x and slope_y [m]
  transient::SignalOptions signal{};
};
[[nodiscard]] std::span<const deck::Name<ForceOptions::Direction>> names(ForceOptions::Direction);
void describe(deck::Description<ForceOptions>& d);

/// Reports places that the machine does not have; `key` is that of the forces in the study's options.
void check_forces(const std::string& key, const std::vector<ForceOptions>& forces, const system::Machine& machine,
                  const deck::Report& report);

/// The node at which a force acts on a machine that was checked.
[[nodiscard]] int node_of(const ForceOptions& force, const system::Machine& machine);
/// A load on the coordinates as it stands in F: coordinate q in row 2 q.
[[nodiscard]] std::vector<transient::Forces::Entry> entries_of(const std::vector<double>& load);
/// Forces for an integrator of `system`, which is that of a machine that was checked. Collective.
[[nodiscard]] transient::Forces make_forces(const std::vector<ForceOptions>& forces, const system::Machine& machine,
                                            const system::Plant& system);

/// For transient::IntegratorOptions.
[[nodiscard]] inline transient::Forces* acting(transient::Forces& forces) {
  return forces.empty() ? nullptr : &forces;
}

}  // namespace whirl::study
