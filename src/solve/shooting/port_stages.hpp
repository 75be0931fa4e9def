#pragma once
// The stages of systems that are made of parts.

#include <memory>
#include <vector>

#include "solve/newton/port_krylov.hpp"
#include "solve/shooting/stage_solver.hpp"

namespace whirl::solve {

/// Makes the solvers of the stages of Runge-Kutta steps from their assembled matrices: FGMRES, with the elimination of
/// the parts in the first matrix of a step as the preconditioner of all others, by the parts' own approximate inverses
/// where all offer them, else by MUMPS. Collective.
class PortStages {
public:
  /// Null if the system has no parts that elimination keeps apart.
  static std::unique_ptr<PortStages> make(problem::System& system);

  /// The next matrix is eliminated anew.
  void begin_step() { similar_.reset(); }
  /// `a` = dF/d(dx/dt) + own dF/dx, scaled, at (angle, x, xdot) in SI.
  [[nodiscard]] std::shared_ptr<const StageSolver> solver(Mat a, double angle, Vec x, Vec xdot, double own);
  [[nodiscard]] std::shared_ptr<const PortMatrix> blocks(Mat a);
  /// The parts' own inverses serve in this step: corrections are dear.
  [[nodiscard]] bool by_inverses() const { return similar_ && similar_->inverse(); }

private:
  explicit PortStages(problem::System& system) : system_(system) {}
  [[nodiscard]] std::shared_ptr<PortElimination> unused(bool by_inverse);
  problem::System& system_;
  std::shared_ptr<const PortLayout> layout_;
  std::shared_ptr<PortKrylov> krylov_;
  std::vector<std::shared_ptr<PortElimination>> made_;  // used again when nobody holds them any more
  std::shared_ptr<PortElimination> similar_;
  bool inverses_ = true;  // until the system has none
};

}  // namespace whirl::solve
