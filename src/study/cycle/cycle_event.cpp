// What is recorded of a bifurcation of cycles: its place, and its normal form with bars from several meshes.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "study/bars/summary_bars.hpp"
#include "study/bifurcation.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "study/equilibrium/equilibrium_event.hpp"
#include "study/equilibrium/hopf_cycles.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"

namespace whirl::study {

using core::check;

io::Bifurcation CycleFollower::bifurcation_here(io::BifurcationType type, double value) const {
  return bifurcation_at(type, value, options_.parameter.path, unit_, context_.machine, options_.unbalance, *system_);
}

std::string CycleFollower::piece(const std::string& what) const {
  return fmt::format("event {} {}", events_ + 1, what);
}

// At u, where `problem` is linearised anew; not a number where there is no such normal form.
double CycleFollower::normal_form(solve::PeriodicProblem& problem, system::Plant& system, solve::Event event,
                                  std::complex<double> critical, Vec u, double step) const {
  if (autonomous() || (event != solve::Event::neimark_sacker && event != solve::Event::flip)) return io::no_value;
  core::Vector row = core::duplicate(u);
  solve::parameter_row(problem, row.get());
  double out = io::no_value;
  (void)has_answer([&] {
    problem.linearise(u, row.get());
    const solve::MotionSize size = motion_of_places(system);
    out = event == solve::Event::flip ? solve::flip_coefficient(problem, u, step, size)
                                      : solve::neimark_sacker_coefficient(problem, u, critical, step, size);
  });
  return out;
}

CycleFollower::Rows CycleFollower::put_bars(io::Bifurcation& b, const solve::LocatedEvent& found,
                                            const solve::Cycle& cycle, Vec u) {
  CycleNumbers here{found.parameter, std::abs(std::arg(found.critical)), cycle.period, io::no_value};
  const bool fold = found.event == solve::Event::cyclic_fold, flip = found.event == solve::Event::flip,
             // Of a flip without film mesh the branch born there tells more: see set_criticality().
      forms =
          (found.refined || !problem_->has_adjoint()) && !fold && !autonomous() && (!flip || system_->has_film_mesh());
  double doubt = 0;
  if (fold && found.refined) here.coefficient = found.quadratic;
  if (forms) {
    const auto with = [&](const char* name, double step) {
      return pieces_->number(piece(name),
                             [&] { return normal_form(*problem_, *system_, found.event, found.critical, u, step); });
    };
    const DifferenceSteps steps = steps_of(law());
    here.coefficient = with("long normal form", steps.longer);
    doubt = doubt_of_steps(with("short normal form", steps.shorter), here.coefficient);
  }
  Bars bars(here.list(), law()), of_coefficient({here.coefficient}, law());
  const std::vector<OtherMesh> all = meshes();
  const solve::Cycle direction = along(found, cycle);
  Rows elsewhere;
  for (auto first = all.begin(), end = first; first != all.end(); first = end) {
    end = std::find_if(first, all.end(), [&](const OtherMesh& m) { return m.axis != first->axis; });
    // A verdict that is lost in one direction needs no others. Of finer films the coarser ones tell.
    const bool open = decided(here.coefficient, doubt);
    const auto also = [&](const OtherMesh& m) { return open && (fold || m.axis == Axis::time || m.spacing > 1); };
    // Near contact the same cycle may leave the validity of the film on another mesh: no number there.
    const auto numbers = [&](const OtherMesh& mesh) {
      const auto there = numbers_on(mesh, found, cycle, direction, also(mesh));
      return there ? there->list() : std::vector<double>{};
    };
    const Rows rows = on_each({first, end}, piece(fmt::format("direction {}", static_cast<int>(first->axis))), numbers);
    elsewhere.insert(elsewhere.end(), rows.begin(), rows.end());
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const OtherMesh& mesh = first[static_cast<std::ptrdiff_t>(k)];
      bars.add(mesh.axis, mesh.spacing, rows[k]);
      if (!also(mesh) || !decided(here.coefficient, doubt)) continue;
      const double c = rows[k].empty() ? io::no_value : rows[k].back();
      of_coefficient.add(mesh.axis, mesh.spacing, {c});
      if (!(c * here.coefficient > 0)) doubt = std::max(doubt, std::abs(c - here.coefficient));
    }
  }
  Bar place = bars[0];
  // Newton's method leaves a residual, and no two solutions agree better.
  place.location = found.bracket + newton_.tolerance * std::abs(found.parameter);
  b.uncertainty = place.total();
  for (const auto& [name, value] : place.parts(true)) b.more[name] = value;
  // The multiplier moves over the unit circle as the place moves.
  if (!fold) b.more["uncertainty_multiplier_modulus"] = std::abs(found.sensitivity) * b.uncertainty;
  const double angle = bars[1].total(), period = bars[2].total();
  b.more["uncertainty_period_s"] = period;
  if (found.event == solve::Event::neimark_sacker) {
    b.more["uncertainty_angle_rad"] = angle;
    b.more["uncertainty_whirl_frequency_rad_s"] =
        angle / cycle.period + b.more["whirl_frequency_rad_s"] * period / cycle.period;
  }
  // What the steps of the differences leave open no mesh decides.
  const double error =
      decided(here.coefficient, doubt) || !law().estimated ? std::max(of_coefficient[0].total(), doubt) : doubt;
  if (fold && std::isfinite(here.coefficient) && here.coefficient != 0)
    put_criticality(b, here.coefficient, error, "below", "above",
                    "second derivative of the parameter along the branch");
  else if (forms && found.event == solve::Event::neimark_sacker)
    put_criticality(b, here.coefficient, error, "supercritical", "subcritical",
                    "coefficient of the map's normal form (Kuznetsov 2004, 5.73)");
  else if (forms)
    put_criticality(b, here.coefficient, error, "subcritical", "supercritical",
                    "cubic coefficient of the flip's normal form (Kuznetsov 2004, 5.68)");
  return elsewhere;
}

// A fold right beside the birth of the branch may be the work of a film's kinks alone.
void CycleFollower::doubt_at_birth(io::Bifurcation& b) const {
  const auto& all = context_.results.summary().bifurcations;
  if (!law().estimated || all.empty() || all.front().type != io::BifurcationType::hopf) return;
  const double apart = std::abs(b.value - all.front().value);
  // What a mesh does to the Hopf point it does to the fold: their bars do not add.
  if (decided(apart, b.uncertainty)) return;
  b.more["distance_from_birth"] = apart;
  b.criticality = "undetermined";
  b.criticality_by = fmt::format(
      "{:.3g} {} from the Hopf point where the branch is born, within the uncertainty: there may be no such fold",
      apart, b.unit);
  context_.results.summary().warnings.push_back(
      fmt::format("the cyclic fold at {:.6g} {} lies within its uncertainty of the Hopf point where the branch is "
                  "born: there may be none",
                  b.value, b.unit));
}

bool CycleFollower::left_as_doubtful(const io::Bifurcation& b, const solve::LocatedEvent& found) {
  if (!doubtful_pair(found, b.uncertainty)) return false;
  changes_.back().bifurcation = -1;
  ++events_;
  context_.results.summary().suspected.push_back(
      {b.value, b.value, unit_,
       fmt::format("two multipliers near +1 ({:.3g} rad apart from it) seem to cross the unit circle, as they do by "
                   "rounding beside a fold",
                   std::abs(std::arg(found.critical)))});
  return true;
}

void CycleFollower::on_event(const solve::LocatedEvent& found, Vec u) {
  const bool asked = wanted(found.event, options_.detect);
  const solve::Cycle cycle = problem_->gather(u);
  system_->set_parameter(cycle.parameter);
  if (found.event == solve::Event::cyclic_fold && at_its_origin(problem_->orbit(u))) return;
  changes_.push_back(change_at(found, asked ? static_cast<int>(context_.results.summary().bifurcations.size()) : -1));
  if (!asked) return;
  io::Bifurcation b = bifurcation_here(type_of(found.event), found.parameter);
  b.period_s = cycle.period;
  put_counts(b, changes_.back());
  if (found.event != solve::Event::cyclic_fold) {
    b.more["angle_rad"] = std::abs(std::arg(found.critical));
    b.more["multiplier_modulus"] = std::abs(found.critical);
  }
  if (found.event == solve::Event::neimark_sacker)
    b.more["whirl_frequency_rad_s"] = std::abs(std::arg(found.critical)) / cycle.period;
  std::optional<FlipSeed> seed;
  if (found.event == solve::Event::flip && found.located) {
    // The branch may have looked elsewhere since it met this flip.
    core::Vector row = core::duplicate(u);
    solve::parameter_row(*problem_, row.get());
    problem_->linearise(u, row.get());
    seed = seed_at(cycle);
    if (options_.follow_flips) seeds_.push_back(*seed);
  }
  Rows on_meshes;
  if (found.located) {
    on_meshes = put_bars(b, found, cycle, u);
  } else {
    b.more["bracket"] = found.bracket;
    b.criticality_by = "not located: lies within the bracket";
    b.uncertainty = found.bracket;
  }
  if (left_as_doubtful(b, found)) return;
  if (seed) {
    const auto twice = twice_the_period(*seed);
    const solve::Restart leaving = leave_flip(*twice, *seed);
    const auto elsewhere = [&](const OtherMesh& mesh) -> std::optional<Parabola> {
      const std::vector<OtherMesh> all = meshes();
      const auto same = std::ranges::find_if(
          all, [&](const OtherMesh& m) { return m.axis == mesh.axis && m.spacing == mesh.spacing; });
      const auto k = static_cast<std::size_t>(same - all.begin());
      if (k >= on_meshes.size() || on_meshes[k].empty()) return {};
      return born_on(mesh, cycle, on_meshes[k].front());
    };
    pieces_->complete(piece("criticality"), b, [&] {
      set_criticality(b, *twice, leaving.u.get(), leaving.tangent.get(), found.sensitivity, elsewhere);
    });
  }
  if (autonomous() && found.event == solve::Event::cyclic_fold) doubt_at_birth(b);
  ++events_;
  shafts_.append(io::name_of(b.type), b.value, orbit_of(u));
  context_.results.summary().bifurcations.push_back(b);
  if (keeps_located_)
    located_.push_back(
        {found.located ? found.event : solve::Event::branch_point, found.critical, cycle, found.sensitivity});
}

}  // namespace whirl::study
