#pragma once
// The stages of systems that are made of parts.

#include <memory>

#include "solve/newton/port_krylov.hpp"
#include "solve/newton/port_maker.hpp"
#include "solve/shooting/stage_solver.hpp"

namespace whirl::solve {

/// Makes the solvers of the stages of Runge-Kutta steps from their assembled matrices: FGMRES, with the elimination of
/// the parts in the first matrix of a step as the preconditioner of all others. Collective.
class PortStages {
public:
  /// Null if the system has no parts that elimination keeps apart.
  static std::unique_ptr<PortStages> make(problem::System& system);

  /// The next matrix is eliminated anew.
  void begin_step() { similar_.reset(); }
  /// `a` = dF/d(dx/dt) + own dF/dx, scaled, at (angle, x, xdot) in SI.
  [[nodiscard]] std::shared_ptr<const StageSolver> solver(Mat a, double angle, Vec x, Vec xdot, double own);
  [[nodiscard]] std::shared_ptr<const PortMatrix> blocks(Mat a) { return maker_->blocks(a); }
  /// The parts' own inverses serve in this step: corrections are dear.
  [[nodiscard]] bool by_inverses() const { return similar_ && similar_->inverse(); }

private:
  explicit PortStages(std::unique_ptr<PortMaker> maker) : maker_(std::move(maker)) {}
  std::unique_ptr<PortMaker> maker_;
  std::shared_ptr<PortKrylov> krylov_;
  std::shared_ptr<PortElimination> similar_;
};

}  // namespace whirl::solve
