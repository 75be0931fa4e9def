// Criticality, read off the branch that is born at a bifurcation.

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "cycle_follower.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/cycle_problem.hpp"
#include "whirl/solve/normal_form.hpp"

namespace whirl::study {

using core::check;

// Near its birth the branch is a parabola p = p_0 + kappa h^2 over the amplitude h, up to h^4. Cycles at h, 2h and 4h
// give differences of the parameter in the ratio 1 : 4, whatever p_0; only then is the sign of kappa believed.
void CycleFollower::set_criticality(io::Bifurcation& b, solve::PeriodicProblem& problem, Vec u, Vec tangent,
                                    double sensitivity) const {
  b.criticality_by = "undetermined: no parabola at small amplitudes of the branch born here";
  if (sensitivity == 0) return;
  core::Vector row = core::duplicate(u), at = core::duplicate(u);
  solve::weighted_row(problem, tangent, row.get());
  for (double smallest = 0.02; smallest > 1e-4; smallest /= 4) {  // root mean square, in clearances
    double parameter[3] = {0, 0, 0};
    bool converged = true;
    for (int k = 0; k < 3 && converged; ++k) {
      const double arclength = smallest * std::pow(2, k) * std::sqrt(state_weight());
      check(VecWAXPY(at.get(), arclength, tangent, u));
      double offset = 0;
      check(VecDot(row.get(), at.get(), &offset));
      converged = solve::newton(problem, at.get(), row.get(), offset, newton_).converged;
      if (converged) parameter[k] = solve::last_entry(problem.comm(), at.get());
    }
    if (!converged) continue;
    const double first = parameter[1] - parameter[0], second = parameter[2] - parameter[1];
    if (!(second / first > 3 && second / first < 5)) continue;
    b.criticality = first * sensitivity > 0 ? "supercritical" : "subcritical";
    b.criticality_by = "parameter at three small amplitudes of the branch born here";
    return;
  }
}

// What the equations at the point itself say, where no branch born there is at hand.
void CycleFollower::set_normal_form(io::Bifurcation& b, const solve::LocatedEvent& found, Vec u) {
  if (found.event == solve::Event::cyclic_fold && found.refined && found.quadratic != 0) {
    b.criticality = found.quadratic > 0 ? "above" : "below";
    b.criticality_by = "second derivative of the parameter along the branch: the side on which the cycles exist";
  }
  auto* cycles = dynamic_cast<solve::CycleProblem*>(problem_.get());
  if (found.event != solve::Event::neimark_sacker || !found.refined || !cycles || autonomous()) return;
  core::Vector row = core::duplicate(u);
  solve::parameter_row(*cycles, row.get());
  double coefficient = 0;
  try {
    cycles->linearise(u, row.get());
    coefficient = solve::neimark_sacker_coefficient(*cycles, u, found.critical);
  } catch (const core::NotConverged& e) {
    b.criticality_by = fmt::format("undetermined: {}", e.what());
  } catch (const core::DomainError& e) {
    b.criticality_by = fmt::format("undetermined: {}", e.what());
  }
  if (!std::isfinite(coefficient) || coefficient == 0) return;
  b.criticality = coefficient < 0 ? "supercritical" : "subcritical";
  b.criticality_by = "normal form of the map over one period (Kuznetsov 2004, 5.73)";
}

// The equilibrium branch gives the error of the film mesh; here it is left open where the film has one.
void CycleFollower::record_hopf(const solve::LocatedEvent& hopf, const solve::Restart& leaving, double omega) {
  io::Bifurcation b = bifurcation_here(io::BifurcationType::hopf, hopf.parameter);
  b.period_s = 2 * std::numbers::pi / omega;
  b.more["whirl_frequency_rad_s"] = omega;
  if (!system_->has_film_mesh()) b.uncertainty = hopf.bracket;
  pieces_->complete("hopf criticality", b,
                    [&] { set_criticality(b, *problem_, leaving.u.get(), leaving.tangent.get(), hopf.sensitivity); });
  context_.results.summary().bifurcations.push_back(b);
  // The equilibrium has no cycle for a locus to start from; its place in the list is kept.
  if (keeps_located_) located_.push_back({solve::Event::branch_point, 0, {}});
}

}  // namespace whirl::study
