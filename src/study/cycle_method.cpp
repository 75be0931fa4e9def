// Which solver of periodic solutions follows the branch.

#include "cycle_follower.hpp"
#include "whirl/solve/cycle_problem.hpp"

namespace whirl::study {

std::unique_ptr<solve::PeriodicProblem> CycleFollower::make_problem(system::RotorSystem& system, int turns,
                                                                    std::vector<double> mesh, bool doubled) const {
  solve::CycleOptions o;
  o.degree = options_.degree;
  o.points = options_.points == CycleBranchOptions::Points::radau ? solve::Points::radau : solve::Points::gauss;
  o.turns = turns;
  o.autonomous = autonomous();
  o.parameter_scale = scale_;
  o.state_weight = state_weight();
  o.base_intervals = options_.intervals * turns / options_.period;
  o.mesh_tolerance = options_.adapt_mesh ? options_.mesh_tolerance : 0;
  if (doubled) mesh = solve::doubled(mesh);
  return std::make_unique<solve::CycleProblem>(context_.comm, system, o, std::move(mesh));
}

}  // namespace whirl::study
