#include "solve/shooting/port_stages.hpp"

namespace whirl::solve {

std::unique_ptr<PortStages> PortStages::make(problem::System& system) {
  auto maker = PortMaker::make(system);
  return maker ? std::unique_ptr<PortStages>(new PortStages(std::move(maker))) : nullptr;
}

std::shared_ptr<const StageSolver> PortStages::solver(Mat a, double angle, Vec x, Vec xdot, double own) {
  auto matrix = maker_->blocks(a);
  if (!krylov_) krylov_ = std::make_shared<PortKrylov>(*maker_->layout(), "stage_");
  std::shared_ptr<PortElimination> by = own != 0 ? similar_ : nullptr;
  if (!by) by = maker_->eliminate(a, *matrix, angle, x, xdot, own);
  if (own != 0) similar_ = by;
  return std::make_shared<const StageSolver>(std::move(matrix), std::move(by), krylov_);
}

}  // namespace whirl::solve
