// What is recorded of a bifurcation of cycles, and how uncertain it is.

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "bifurcation.hpp"
#include "cycle_follower.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/augmented_problem.hpp"

namespace whirl::study {

using core::check;

// How far the bifurcation moves when the discretisation changes: one corrected cycle at the same parameter, and the
// distance from the border there over its slope along the branch. Folds have no such slope; there the branch itself is
// moved and its parameter read off.
double CycleFollower::shift(const solve::LocatedEvent& found, const solve::Cycle& given, bool doubled_mesh,
                            bool half_film) const {
  const auto other = half_film ? make_system(true) : nullptr;
  system::Plant& system = other ? *other : *system_;
  const solve::Cycle cycle = on_film_of(system, given);
  const auto made = make_problem(system, options_.period, cycle.mesh, doubled_mesh);
  solve::PeriodicProblem& problem = *made;
  if (autonomous()) problem.set_phase_reference(cycle);
  core::Vector u = problem.scatter(cycle), row = core::duplicate(u.get());
  const bool fold = found.event == solve::Event::cyclic_fold;
  double offset = found.parameter;
  if (fold) {
    // The direction of the branch at its fold has no part in the parameter. It is that of the branch found: the other
    // discretisation is not at a fold here, and its own direction would hold the parameter instead of the amplitude.
    core::Vector at = problem_->scatter(given), along = core::duplicate(at.get()), own_row = core::duplicate(at.get()),
                 rhs = core::duplicate(at.get());
    check(VecCopy(at.get(), along.get()));
    solve::set_last_entry(problem_->comm(), along.get(), 0);
    solve::weighted_row(*problem_, along.get(), own_row.get());
    problem_->linearise(at.get(), own_row.get());
    check(VecSet(rhs.get(), 0.0));
    solve::set_last_entry(problem_->comm(), rhs.get(), 1);
    (void)solve::solve_linear(*problem_, rhs.get(), along.get(), "tangent_");
    // Own states of a film are resampled with the journal's place, affinely: a direction is the difference of two.
    solve::Cycle direction = problem_->gather(along.get()), moved = given;
    moved.x += direction.x;
    direction.x = on_film_of(system, std::move(moved)).x - cycle.x;
    const core::Vector tangent = problem.scatter(direction);
    solve::set_last_entry(problem.comm(), tangent.get(), 0);
    solve::weighted_row(problem, tangent.get(), row.get());
    check(VecScale(row.get(), 1 / std::sqrt(solve::inner(problem, tangent.get(), tangent.get()))));
    check(VecDot(row.get(), u.get(), &offset));
  } else {
    solve::parameter_row(problem, row.get());
  }
  // Where the fold is on the other discretisation; if that cannot be had, where the branch of the same amplitude is.
  if (auto* cycles = dynamic_cast<solve::CycleProblem*>(&problem); fold && cycles) {
    const auto there = solve::refine(*cycles, found, u.get(), solve::any_tangent(problem, u.get()).get(), newton_);
    if (there && std::abs(there->parameter - found.parameter) < continuation_.max_step)
      return std::abs(there->parameter - found.parameter);
  }
  const auto result = solve::newton(problem, u.get(), row.get(), offset, newton_);
  if (!result.converged) return std::numeric_limits<double>::quiet_NaN();
  if (fold) return std::abs(solve::last_entry(problem.comm(), u.get()) - found.parameter);
  problem.linearise(u.get(), row.get());
  double nearest = std::numeric_limits<double>::infinity(), distance = 0;
  for (const auto& mu : problem.multipliers()) {
    const double apart = std::min(std::abs(mu - found.critical), std::abs(mu - std::conj(found.critical)));
    if (apart < nearest) {
      nearest = apart;
      distance = distance_of_multiplier(mu);
    }
  }
  return found.sensitivity != 0 ? std::abs(distance / found.sensitivity) : std::numeric_limits<double>::quiet_NaN();
}

io::Bifurcation CycleFollower::bifurcation_here(io::BifurcationType type, double value) const {
  return bifurcation_at(type, value, options_.parameter.path, unit_, context_.machine, options_.unbalance, *system_);
}

std::string CycleFollower::piece(const std::string& what) const {
  return fmt::format("event {} {}", events_ + 1, what);
}

void CycleFollower::on_event(const solve::LocatedEvent& found, Vec u) {
  if (!wanted(found.event, options_.detect)) return;
  const solve::Cycle cycle = problem_->gather(u);
  if (found.event == solve::Event::cyclic_fold && at_simple_cycle(problem_->orbit(u))) return;
  io::Bifurcation b = bifurcation_here(type_of(found.event), found.parameter);
  b.period_s = cycle.period;
  if (found.event == solve::Event::flip && found.located) {
    const FlipSeed seed = seed_at(cycle);
    if (options_.follow_flips) seeds_.push_back(seed);
    const auto twice = twice_the_period(seed);
    const solve::Restart leaving = leave_flip(*twice, seed);
    pieces_->complete(piece("criticality"), b,
                      [&] { set_criticality(b, *twice, leaving.u.get(), leaving.tangent.get(), found.sensitivity); });
  }
  if (found.event != solve::Event::cyclic_fold) {
    b.more["angle_rad"] = std::abs(std::arg(found.critical));
    b.more["multiplier_modulus"] = std::abs(found.critical);
  }
  if (found.event == solve::Event::neimark_sacker) {
    const double frequency = std::abs(std::arg(found.critical)) / cycle.period;
    b.more["whirl_frequency_rad_s"] = frequency;
  }
  if (found.located) {
    // Near contact the same cycle may leave the validity of the film on another mesh: no estimate then.
    const auto estimate = [&](bool doubled_mesh, bool half_film) {
      try {
        return shift(found, cycle, doubled_mesh, half_film);
      } catch (const core::DomainError&) {
        return std::numeric_limits<double>::quiet_NaN();
      } catch (const core::NotConverged&) {
        return std::numeric_limits<double>::quiet_NaN();
      } catch (const core::InputError&) {  // grooves that leave nothing of a coarser mesh
        return std::numeric_limits<double>::quiet_NaN();
      }
    };
    const double time = pieces_->number(piece("time mesh"), [&] { return estimate(true, false); });
    const double film =
        system_->has_film_mesh() ? pieces_->number(piece("film mesh"), [&] { return estimate(false, true); }) : 0;
    // Twice the change to the doubled time mesh: the rest that a yet finer one would bring is smaller than that change.
    b.more["uncertainty_time_mesh"] = 2 * time;
    b.more["uncertainty_film_mesh"] = film;
    b.uncertainty = 2 * time + film + found.bracket;
  } else {
    b.more["bracket"] = found.bracket;
    b.criticality_by = "not located: lies within the bracket";
    b.uncertainty = found.bracket;
  }
  pieces_->complete(piece("normal form"), b, [&] { set_normal_form(b, found, u); });
  ++events_;
  context_.results.summary().bifurcations.push_back(b);
  if (keeps_located_)
    located_.push_back(
        {found.located ? found.event : solve::Event::branch_point, found.critical, cycle, found.sensitivity});
}

}  // namespace whirl::study
