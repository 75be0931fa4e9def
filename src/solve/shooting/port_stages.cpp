#include "solve/shooting/port_stages.hpp"

#include "whirl/core/agree.hpp"

namespace whirl::solve {

std::unique_ptr<PortStages> PortStages::make(problem::System& system) {
  if (!PortElimination::serves(system.fields())) return nullptr;
  return std::unique_ptr<PortStages>(new PortStages(system));
}

// Of a matrix without dF/dx the parts' inverses may know nothing.
std::shared_ptr<PortElimination> PortStages::unused(bool by_inverse) {
  if (!by_inverse) return std::make_shared<PortElimination>(system_.fields());
  for (const auto& e : made_)
    if (e.use_count() == 1) return e;
  auto inverse = inverses_ ? system_.make_part_inverse() : nullptr;
  inverses_ = inverse != nullptr;
  return made_.emplace_back(std::make_shared<PortElimination>(system_.fields(), std::move(inverse)));
}

std::shared_ptr<const PortMatrix> PortStages::blocks(Mat a) {
  if (!layout_) layout_ = std::make_shared<const PortLayout>(a, system_.fields());
  auto out = std::make_shared<PortMatrix>(layout_);
  out->take(a);
  return out;
}

std::shared_ptr<const StageSolver> PortStages::solver(Mat a, double angle, Vec x, Vec xdot, double own) {
  auto matrix = blocks(a);
  if (!krylov_) krylov_ = std::make_shared<PortKrylov>(*layout_, "stage_");
  std::shared_ptr<PortElimination> by = own != 0 ? similar_ : nullptr;
  if (!by) {
    by = unused(own != 0);
    if (by->inverse()) by->inverse()->set(angle, x, xdot, own, 1);
    try {
      by->factorise(a, *matrix);
    } catch (const core::NotConverged&) {
      core::agree(system_.comm(), [] { throw core::DomainError("the parts in a stage are singular"); });
    }
    if (own != 0) similar_ = by;
  }
  return std::make_shared<const StageSolver>(std::move(matrix), std::move(by), krylov_);
}

}  // namespace whirl::solve
