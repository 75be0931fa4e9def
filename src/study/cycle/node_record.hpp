#pragma once
// What the shaft does over a branch of cycles: how far it moves at chosen nodes, and the whole of it on chosen cycles.

#include <string>
#include <vector>

#include "study/state_rows.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/table.hpp"
#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// Amplitudes of the shaft in space at nodes (1-based), one row per cycle. Replicated on all ranks.
class NodeRecord {
public:
  NodeRecord(std::vector<int> nodes, std::string unit);

  /// Of each node [m], 0-peak; empty without nodes, or if the system is no rotor.
  struct NodeSizes {
    std::vector<double> amplitude;  ///< largest distance from the mean position
    std::vector<double> x, y;       ///< half the travel
  };
  /// Collective on the system's communicator.
  [[nodiscard]] NodeSizes sizes(const CycleOrbit& orbit) const;
  /// Adds a cycle with its parameter in the unit of the branch. Collective on the system's communicator. Nothing
  /// happens without nodes, or if the system is no rotor.
  void append(double parameter, const CycleOrbit& orbit);
  /// Removes the last row, if there is one.
  void drop_last();
  /// Table of parameter, `amplitude` (largest distance from the mean position), `x` and `y` (half the travel) [m],
  /// 0-peak [cycle][node], with `node`; nothing without nodes.
  void write(io::Group& group) const;
  void read(const io::Group& group);

private:
  std::vector<int> nodes_;
  std::string unit_;
  io::Table table_;
};

/// The shaft in space over one period of cycles that are asked for or at which something happens. Replicated on all
/// ranks.
class ShaftOrbits {
public:
  explicit ShaftOrbits(std::string unit) : unit_(std::move(unit)) {}
  /// Adds a cycle with what it is (`at`, or the kind of the bifurcation) and its parameter in the unit of the branch.
  /// Collective on the system's communicator. Nothing happens if the system is no rotor with nodes along a shaft.
  void append(const std::string& what, double parameter, const CycleOrbit& orbit);
  /// `shaft`: `what`, `parameter`, `period` [s] of each cycle, `x` and `y` [m] [cycle][time][node] and the nodes' `z`;
  /// nothing without cycles.
  void write(io::Group& group) const;
  void read(const io::Group& group);

private:
  std::string unit_;
  std::vector<std::string> what_;
  std::vector<double> z_, parameter_, period_, x_, y_;
};

}  // namespace whirl::study
