// Which solver of periodic solutions follows the branch.

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "study/cycle/cycle_follower.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/cycle/spread_collocation.hpp"
#include "whirl/solve/shooting/newton_picard.hpp"
#include "whirl/solve/shooting/shooting_problem.hpp"

namespace whirl::study {
namespace {

using Method = CycleBranchOptions::Method;

solve::Tableau tableau_of(CycleBranchOptions::Stepping scheme) {
  using enum CycleBranchOptions::Stepping;
  switch (scheme) {
    case sdirk_2:
      return solve::sdirk(2);
    case sdirk_4:
      return solve::sdirk(4);
    case radau_iia_2:
      return solve::radau_iia(2);
    case radau_iia_3:
      return solve::radau_iia(3);
    case improved_euler:
      return solve::heun();
    case third_order:
      return solve::third_order();
    case classical:
      return solve::classical();
  }
  std::abort();
}

}  // namespace

double CycleFollower::order_of_scheme() const {
  if (options_.method != Method::collocation) return tableau_of(options_.scheme).order;
  return 2 * options_.degree - (options_.points == CycleBranchOptions::Points::radau ? 1 : 0);
}

Layout CycleFollower::layout(std::size_t intervals) const {
  const bool radau = options_.method == Method::collocation && options_.points == CycleBranchOptions::Points::radau;
  const Sharing sharing =
      options_.method == Method::newton_picard ? Sharing::machine
      : options_.method == Method::shooting    ? Sharing::nothing
      : radau && spreads_cycles(context_.layout, context_.machine, options_.intervals, options_.degree)
          ? Sharing::cycles
          : Sharing::intervals;
  // The groups of a machine whose states are spread stay the same on all meshes.
  Layout out =
      plan(context_, sharing, sharing == Sharing::cycles ? static_cast<std::size_t>(options_.intervals) : intervals);
  if (alone_) out.time = MPI_COMM_SELF;
  return out;
}

std::unique_ptr<solve::PeriodicProblem> CycleFollower::make_problem(system::Plant& system, int turns,
                                                                    std::vector<double> mesh, double finer) const {
  const int laps = turns / options_.period;
  int steps = steps_of(options_);
  if (options_.method == Method::shooting) {
    mesh = {0, 1};
    steps *= laps;
  }
  // Where an interval is one step, as in a finite-difference method, it is the mesh that makes steps shorter.
  if (finer > 1 && (options_.method == Method::collocation || steps == 1))
    for (double left = finer; left > 1; left /= 2) mesh = solve::doubled(mesh);
  else
    steps = static_cast<int>(std::lround(steps * finer));

  const auto common = [&](auto o) {
    // One multiplier of a self-excited cycle says nothing.
    o.multipliers = std::max(solve::CycleOptions().multipliers, options_.multipliers + 1);
    o.turns = turns;
    o.autonomous = autonomous();
    o.parameter_scale = scale_;
    o.state_weight = state_weight();
    return o;
  };
  const double tolerance = options_.adapt_mesh ? options_.mesh_tolerance : 0;
  if (options_.method == Method::newton_picard) {
    auto o = common(solve::NewtonPicardOptions());
    o.radius = options_.radius;
    o.constant_rates = system.constant_rates();
    return std::make_unique<solve::NewtonPicardProblem>(system, o, tableau_of(options_.scheme), steps, std::move(mesh));
  }
  const Layout shared = layout(mesh.size() - 1);
  if (shared.spread) {
    auto o = common(solve::SpreadCollocationOptions());
    o.radius = 0.2;
    o.constant_rates = system.constant_rates();
    o.degree = options_.degree;
    o.base_intervals = options_.intervals * laps;
    o.mesh_tolerance = tolerance;
    return std::make_unique<solve::SpreadCollocation>(system, o, std::move(mesh),
                                                      solve::TimeGroups(shared.world, shared.time));
  }
  auto o = common(solve::CycleOptions());
  o.degree = options_.degree;
  o.points = options_.points == CycleBranchOptions::Points::radau ? solve::Points::radau : solve::Points::gauss;
  o.base_intervals = options_.intervals * laps;
  o.mesh_tolerance = tolerance;
  if (options_.method == Method::collocation)
    return std::make_unique<solve::CycleProblem>(shared.time, system, o, std::move(mesh));
  return std::make_unique<solve::ShootingProblem>(shared.time, system, o, tableau_of(options_.scheme), steps,
                                                  std::move(mesh), system.constant_rates());
}

}  // namespace whirl::study
