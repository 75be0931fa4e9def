#pragma once
// Blocks and eliminations of the many matrices that a system made of parts has along a motion.

#include <memory>
#include <vector>

#include "solve/newton/port_elimination.hpp"

namespace whirl::solve {

/// Matrices of one system in blocks, and the elimination of their parts: by the parts' own approximate inverses where
/// all offer them, else by MUMPS. Collective.
class PortMaker {
public:
  /// Null if the system has no parts.
  static std::unique_ptr<PortMaker> make(problem::System& system);

  /// The blocks of `a`, a Jacobian of the system, scaled.
  [[nodiscard]] std::shared_ptr<const PortMatrix> blocks(Mat a);
  /// Of dF/d(dx/dt) + own dF/dx in its `blocks`, scaled, at (angle, x, xdot) in SI; own = 0 never takes the
  /// parts' inverses, which may know nothing of such a matrix. With `held` only of the parts, for
  /// PortElimination::solve_held(). What nobody holds any more is used again. Throws core::DomainError, on all ranks,
  /// if a part is singular.
  [[nodiscard]] std::shared_ptr<PortElimination> eliminate(const PortMatrix& blocks, double angle, Vec x, Vec xdot,
                                                           double own, bool held = false);
  /// Of the blocks; null before the first of them.
  [[nodiscard]] const PortLayout* layout() const { return layout_.get(); }

private:
  explicit PortMaker(problem::System& system) : system_(system) {}
  [[nodiscard]] std::shared_ptr<PortElimination> unused(bool by_inverse);
  problem::System& system_;
  std::shared_ptr<const PortLayout> layout_;
  std::vector<std::shared_ptr<PortElimination>> made_;  // used again when nobody holds them any more
  bool inverses_ = true;                                // until the system has none
};

}  // namespace whirl::solve
