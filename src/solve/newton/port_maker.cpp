#include "solve/newton/port_maker.hpp"

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

std::unique_ptr<PortMaker> PortMaker::make(problem::System& system) {
  if (problem::parts_of(system.fields()).size() < 2) return nullptr;
  return std::unique_ptr<PortMaker>(new PortMaker(system));
}

std::shared_ptr<PortElimination> PortMaker::unused(bool by_inverse) {
  if (!by_inverse) return std::make_shared<PortElimination>(system_.fields());
  for (const auto& e : made_)
    if (e.use_count() == 1) return e;
  auto inverse = inverses_ ? own_inverse(system_) : nullptr;
  inverses_ = inverse != nullptr;
  return made_.emplace_back(std::make_shared<PortElimination>(system_.fields(), std::move(inverse)));
}

std::shared_ptr<const PortMatrix> PortMaker::blocks(Mat a) {
  if (!layout_) layout_ = std::make_shared<const PortLayout>(a, system_.fields());
  auto out = std::make_shared<PortMatrix>(layout_);
  out->take(a);
  return out;
}

std::shared_ptr<PortElimination> PortMaker::eliminate(const PortMatrix& blocks, double angle, Vec x, Vec xdot,
                                                      double own, bool held) {
  std::shared_ptr<PortElimination> out = unused(own != 0);
  if (out->inverse()) out->inverse()->set({angle, x, xdot}, own, 1);
  try {
    if (held)
      out->factorise_parts(blocks);
    else
      out->factorise(blocks);
  } catch (const core::NotConverged&) {
    core::agree(system_.comm(), [] { throw core::DomainError("the parts in a stage are singular"); });
  }
  return out;
}

}  // namespace whirl::solve
