// Criticality, read off the branch that is born at a bifurcation.

#include <fmt/core.h>

#include <cmath>

#include "study/bars/shaft_mesh.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "study/equilibrium/equilibrium_event.hpp"

namespace whirl::study {

using core::check;

// Near its birth the branch is a parabola p = p_0 + kappa h^2 over the amplitude h, up to h^4. Cycles at h, 2h and 4h
// give kappa twice, from the first and from the second pair, whatever p_0; only if they agree it is believed.
std::optional<Parabola> CycleFollower::parabola(solve::PeriodicProblem& problem, Vec u, Vec tangent) const {
  core::Vector row = core::duplicate(u), at = core::duplicate(u);
  solve::weighted_row(problem, tangent, row.get());
  for (double smallest = 0.02; smallest > 1e-4; smallest /= 4) {  // root mean square, in clearances
    double parameter[3] = {0, 0, 0};
    bool converged = true;
    for (int k = 0; k < 3 && converged; ++k) {
      const double arclength = smallest * std::pow(2, k) * std::sqrt(state_weight());
      // What the last cycle had besides its share in the tangent grows with the square of the amplitude.
      if (k > 0) {
        check(VecAXPY(at.get(), -arclength / 2, tangent));
        check(VecAXPBY(at.get(), -3, 4, u));
        check(VecAXPY(at.get(), arclength, tangent));
      } else {
        check(VecWAXPY(at.get(), arclength, tangent, u));
      }
      double offset = 0;
      check(VecDot(row.get(), at.get(), &offset));
      converged = solve::newton(problem, at.get(), row.get(), offset, newton_).converged;
      if (converged) parameter[k] = solve::last_entry(problem.comm(), at.get());
    }
    if (!converged) continue;
    const double first = (parameter[1] - parameter[0]) / (3 * smallest * smallest),
                 second = (parameter[2] - parameter[1]) / (12 * smallest * smallest);
    if (second / first > 0.75 && second / first < 1.25) return Parabola{first, std::abs(second - first)};
  }
  return {};
}

// A branch is supercritical that lives where the old one is unstable.
void CycleFollower::set_criticality(io::Bifurcation& b, solve::PeriodicProblem& problem, Vec u, Vec tangent,
                                    double sensitivity,
                                    const std::function<std::optional<Parabola>(const OtherMesh&)>& elsewhere) const {
  const auto born = sensitivity == 0 ? std::nullopt : parabola(problem, u, tangent);
  const bool asked = !b.criticality.empty();
  if (!born) {
    if (!asked) {
      b.criticality = "undetermined";
      b.criticality_by = "no parabola at small amplitudes of the branch born here";
    }
    return;
  }
  const double kappa = born->curvature * (sensitivity > 0 ? -1 : 1);
  const char* verdict = kappa < 0 ? "supercritical" : "subcritical";
  b.more["branch_curvature"] = born->curvature;
  double error = law().estimated ? born->error : io::no_value;
  if (!asked && elsewhere && law().estimated) {
    Bars bars({born->curvature}, law());
    double change = 0;
    for (const OtherMesh& mesh : meshes()) {
      if (mesh.axis != Axis::time || !decided(born->curvature, born->error + change)) continue;
      const auto there = elsewhere(mesh);
      const double c = there ? there->curvature : io::no_value;
      bars.add(mesh.axis, mesh.spacing, {c});
      // A sign that changes with the mesh is none.
      if (!(c * born->curvature > 0)) change = std::max(change, std::abs(c - born->curvature));
    }
    error += std::max(bars[0].total(), change);
  }
  b.more["branch_curvature_uncertainty"] = error;
  if (!asked) {
    put_criticality(b, kappa, error, "supercritical", "subcritical",
                    "parameter at three small amplitudes of the branch born here");
  } else if (b.criticality != "undetermined" && b.criticality != verdict) {
    b.criticality_by = fmt::format("{}, but the branch born here says {}", b.criticality_by, verdict);
    b.criticality = "undetermined";
  }
}

void CycleFollower::record_hopf(const solve::LocatedEvent& hopf, Vec equilibrium, const solve::Restart& leaving) {
  io::Bifurcation b = bifurcation_here(io::BifurcationType::hopf, hopf.parameter);
  put_counts(b, change_at(hopf, -1));
  solve::NewtonOptions newton = newton_;
  newton.max_iterations = 20;
  if (layout().count > 1) newton.replay_log = nullptr;  // others do not have what this rank finds on its way
  std::function<std::unique_ptr<system::Plant>()> cut;
  if (has_shaft_mesh(context_.machine, context_.layout)) cut = [this] { return make_system({1, 1}, 2); };
  pieces_->complete("hopf bars", b, [&] {
    study::describe(
        b, {*system_, equilibrium, hopf, scale_, state_weight(), newton, film_meshes(context_.machine, context_.layout),
            law_of(context_.machine, context_.layout), [this](const auto& cells) { return make_system(cells); },
            [this](const auto& name, std::size_t n, const auto& work) {
              return distribute_numbers(layout(), n, work, *pieces_, "hopf " + name);
            },
            cut});
  });
  pieces_->complete("hopf criticality", b,
                    [&] { set_criticality(b, *problem_, leaving.u.get(), leaving.tangent.get(), hopf.sensitivity); });
  context_.results.summary().set("hopf", hopf.parameter, unit_, {{"uncertainty", b.uncertainty}});
  context_.results.summary().set("hopf.whirl_frequency", b.more["whirl_frequency_rad_s"], "rad/s",
                                 {{"uncertainty", b.more["uncertainty_whirl_frequency_rad_s"]}});
  context_.results.summary().bifurcations.push_back(b);
  // The equilibrium has no cycle for a locus to start from; its place in the list is kept.
  if (keeps_located_) located_.push_back({solve::Event::branch_point, 0, {}});
}

}  // namespace whirl::study
