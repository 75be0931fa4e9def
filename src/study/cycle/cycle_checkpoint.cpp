// What a branch of cycles needs to go on after an interruption.

#include <fmt/core.h>

#include "study/branch_state.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "study/packed.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/newton/newton.hpp"

namespace whirl::study {

void write_seeds(io::Group& group, const std::vector<FlipSeed>& seeds, const SharedRows& like) {
  group.set("count", static_cast<int>(seeds.size()));
  group.set("restart", 1);
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    auto& g = group.child(fmt::format("{}", k + 1));
    write_cycle(g.child("cycle"), seeds[k].cycle, like);
    write_cycle(g.child("direction"), seeds[k].direction, like);
  }
}

std::size_t count_seeds(const io::Group& group) {
  return static_cast<std::size_t>(group.integer("count"));
}

std::vector<FlipSeed> read_seeds(const io::Group& group, const SharedRows& like) {
  std::vector<FlipSeed> seeds;
  for (std::size_t k = 1; k <= count_seeds(group); ++k) {
    const auto& g = group.group(fmt::format("{}", k));
    seeds.push_back({read_cycle(g.group("cycle"), like), read_cycle(g.group("direction"), like)});
  }
  return seeds;
}

// The next phase is measured against this cycle, in a resumed branch as in this one. The tangent obeyed the condition
// before: where few points of the cycle are unknowns it slides along the cycle by no small angle.
void CycleFollower::renew_phase(const solve::Cycle& cycle, Vec u, Vec tangent) {
  problem_->set_phase_reference(cycle);
  const auto renew = [&] {
    core::Vector row = core::duplicate(u), rhs = core::duplicate(u);
    solve::weighted_row(*problem_, tangent, row.get());
    problem_->linearise(u, row.get());
    core::check(VecSet(rhs.get(), 0.0));
    solve::set_last_entry(problem_->comm(), rhs.get(), 1);
    core::Vector renewed = core::duplicate(tangent);
    (void)solve::solve_linear(*problem_, rhs.get(), renewed.get(), "tangent_");
    core::check(VecCopy(renewed.get(), tangent));
    core::check(VecScale(tangent, 1 / std::sqrt(solve::inner(*problem_, tangent, tangent))));
  };
  try {
    const auto renewed = solve::ReplayLog::ask(newton_.replay_log, "phase", {core::norm(u)}, [&](const auto&) {
      renew();
      return solve::ReplayLog::Answer{{}, {}, {solve::ReplayLog::keep(newton_.replay_log, tangent)}};
    });
    solve::ReplayLog::give(renewed.vectors.at(0), tangent);
  } catch (const core::NotConverged&) {  // singular, at a branch point for one: the old one serves
  }
}

void CycleFollower::save(const solve::ResumePoint& at, Vec u, Vec tangent) {
  const solve::Cycle cycle = problem_->gather(u);
  // What a resumed branch reads is rounded once more. This one goes on from there as well, so that both are the same.
  const auto round = [this](Vec v) {
    const solve::Cycle c = problem_->gather(v);
    core::check(VecCopy(problem_->scatter(c).get(), v));
    return c;
  };
  const bool saves = newton_.replay_log != nullptr;
  if (saves) (void)round(u);
  if (autonomous()) renew_phase(cycle, u, tangent);
  // Of a branch that has returned there is nothing to go on with.
  returned_ = may_return() && returned(problem_->orbit(u));
  if (!saves || returned_) return;
  const solve::Cycle direction = round(tangent);
  if (!pieces_->state_due()) return;
  io::Group state;
  record_.write(state.child("record"), true);
  nodes_.write(state);
  shafts_.write(state);
  multiplier_bars_.write(state.child("multiplier_bars"));
  put_packed(state, "changes", changes_, "of stability");
  write_cycle(state.child("cycle"), cycle, stored());
  write_cycle(state.child("tangent"), direction, stored());
  // Cycles asked for begin there, on the mesh before its adaptation.
  if (last_ && !options_.at.empty()) write_cycle(state.child("last"), *last_, stored());
  if (nearest_) {
    io::Group& nearest = state.child("nearest");
    write_cycle(nearest.child("cycle"), nearest_->cycle, stored());
    put_packed(nearest, "point", *nearest_, "of which the cycle is");
  }
  state.set("leaves", leaves_ ? 1 : 0);
  state.set("period_scale", problem_->period_scale());
  solve::BranchPoint now = at.point;
  now.slope = solve::last_entry(problem_->comm(), tangent);
  put_packed(state, "point", now, "the last one");
  write_memory(state.child("memory"), *at.memory, layout().shared);
  state.set("next_step", at.next_step);
  state.set("largest_difference", largest_);
  state.set("events", events_);
  write_summary(state.child("summary"), context_.results.summary());
  write_seeds(state.child("flips"), seeds_, stored());
  write(state.child("located"), located_);
  limits_.write(state, stored());
  pieces_->save(std::move(state));
}

std::optional<solve::Restart> CycleFollower::restore() {
  pieces_ = std::make_unique<Pieces>(context_.results, context_.resume, options_.checkpoint, layout().order());
  newton_.replay_log = continuation_.newton.replay_log = pieces_->replay_log();
  if (newton_.replay_log) newton_.replay_log->by_rows = layout().shared ? core::size_of(context_.comm) : 0;
  if (!pieces_->state().has_group("cycle")) return std::nullopt;
  const io::Group& state = pieces_->state();
  record_.read(state.group("record"));
  nodes_.read(state);
  shafts_.read(state);
  multiplier_bars_.read(state.group("multiplier_bars"));
  changes_ = take_packed<std::vector<BranchChange>>(state, "changes");
  const solve::Cycle cycle = read_cycle(state.group("cycle"), stored()),
                     direction = read_cycle(state.group("tangent"), stored());
  problem_ = make_problem(*system_, options_.period, cycle.mesh, 1);
  if (autonomous()) {
    solve::Cycle first = cycle;  // gives the period its unit
    first.period = state.real("period_scale");
    problem_->set_phase_reference(first);
    problem_->set_phase_reference(cycle);
  }
  read_summary(state.group("summary"), context_.results.summary());
  events_ = static_cast<int>(state.integer("events"));
  solve::Restart restart{problem_->scatter(cycle),
                         problem_->scatter(direction),
                         state.real("next_step"),
                         take_packed<solve::BranchPoint>(state, "point"),
                         {}};
  if (pieces_->same_layout()) restart.memory = read_memory(state.group("memory"), restart.u.get());
  seeds_ = read_seeds(state.group("flips"), stored());
  located_ = read(state.group("located"));
  limits_.read(state, stored());
  last_ = state.has_group("last") ? read_cycle(state.group("last"), stored()) : cycle;
  if (state.has_group("nearest")) {
    const io::Group& nearest = state.group("nearest");
    nearest_ = take_packed<Watched>(nearest, "point");
    nearest_->cycle = read_cycle(nearest.group("cycle"), stored());
  }
  leaves_ = state.integer("leaves") != 0;
  filled_ = restart.point.filled;
  largest_ = state.real("largest_difference");
  const CycleOrbit orbit = orbit_of(restart.u.get());
  if (may_return()) (void)returned(orbit.cycle);
  add_margin(restart.point.parameter, orbit);
  return restart;
}

}  // namespace whirl::study
