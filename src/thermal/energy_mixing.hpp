#pragma once
// Grooves whose oil is mixed: one temperature for what comes from upstream and the fresh oil.

#include <vector>

#include "whirl/thermal/flow.hpp"
#include "whirl/thermal/rows.hpp"

namespace whirl::thermal {

/// Every cell of a groove exchanges G (T - T_mean) with the mean of the groove's cells. Summed over them nothing is
/// left, so that the film's balance is untouched. G is so large beside what flows through a cell that all have one
/// temperature: that at which the enthalpy of what flows in, carried over and fresh, and the heat there leave again.
class GrooveMixing {
public:
  /// `member` [r, n]: the groove of a node, counted from 1, 0 of none; empty: there are none. `across` [r, n], W/K,
  /// between two layers. Collective.
  void update(const Rows& rows, const Flow& flow, double heat_capacity, const std::vector<double>& across,
              const std::vector<int>& member);
  /// Whether any rank has a groove that mixes.
  [[nodiscard]] bool any() const { return !conductance_.empty(); }
  /// W/K, G of each cell of a column; 0 outside of grooves.
  [[nodiscard]] double at(PetscInt node) const {
    if (!any()) return 0;
    const int groove = member_[static_cast<std::size_t>(node)];
    return groove > 0 ? conductance_[static_cast<std::size_t>(groove - 1)] : 0;
  }
  /// Adds W [r, n, l], linear in x. Collective where any().
  void add(const Rows& rows, const double* x, double* out) const;
  /// The mean of each groove. Collective where any().
  [[nodiscard]] std::vector<double> means(const Rows& rows, const double* x) const;

private:
  std::vector<int> member_;
  std::vector<double> conductance_, cells_;  // of each groove
};

}  // namespace whirl::thermal
