// The same bifurcation on another film mesh.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "study/cycle/cycle_follower.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"

namespace whirl::study {

using core::check;

namespace {

constexpr int most_solves = 40;
constexpr int few_iterations = 6;  // of Newton: a step that needs more was too long, and may never arrive

[[noreturn]] void not_found(const std::string& why) {
  throw core::NotConverged("the bifurcation was not found on this film mesh: " + why);
}

}  // namespace

solve::Cycle CycleFollower::on_film_of(const system::Plant& to, solve::Cycle c) const {
  return resampled(to, *system_, std::move(c));
}

Relocated CycleFollower::relocate(const Located& from, const CycleFollower& other, solve::ReplayLog* replay_log) {
  newton_.replay_log = replay_log;
  if (replay_log) replay_log->by_rows = layout().shared ? core::size_of(context_.comm) : 0;
  const solve::Cycle cycle = other.on_film_of(*system_, from.cycle);
  problem_ = make_problem(*system_, options_.period, cycle.mesh, 1);
  if (autonomous()) problem_->set_phase_reference(cycle);
  core::Vector u = problem_->scatter(cycle);
  Relocated out{from, 0, 0};
  if (from.event == solve::Event::cyclic_fold)
    relocate_fold(u, out);
  else
    relocate_crossing(u, out);
  out.found.cycle = problem_->gather(u.get());
  return out;
}

void CycleFollower::correct(Vec u, Vec row, double offset, const solve::NewtonOptions& newton, Relocated& out) {
  const auto result = solve::newton(*problem_, u, row, offset, newton);
  if (!result.converged) not_found(result.reason);
  if (++out.solves > most_solves) not_found("the iteration does not settle");
}

// What a secant reads off the cycle u, once; with a warm start for the next ones.
solve::ReplayLog::Answer CycleFollower::read_off(Vec u, Vec row,
                                                 const std::function<void(solve::ReplayLog::Answer&)>& work) {
  solve::ReplayLog::Answer all = solve::ReplayLog::ask(newton_.replay_log, "secant", {core::norm(u)}, [&](const auto&) {
    problem_->linearise(u, row);
    solve::ReplayLog::Answer found;
    work(found);
    const std::vector<double> warm = problem_->warm_start();
    found.numbers.insert(found.numbers.end(), warm.begin(), warm.end());
    found.numbers.push_back(static_cast<double>(warm.size()));
    return found;
  });
  std::vector<double>& numbers = all.numbers;
  const auto warm = static_cast<std::ptrdiff_t>(numbers.back());
  numbers.pop_back();
  problem_->take_warm_start({numbers.end() - warm, numbers.end()});
  numbers.resize(numbers.size() - static_cast<std::size_t>(warm));
  return all;
}

// Secant on the distance of the critical multiplier from the unit circle over the parameter.
void CycleFollower::relocate_crossing(core::Vector& u, Relocated& out) {
  core::Vector row = core::duplicate(u.get());
  solve::parameter_row(*problem_, row.get());
  double p = out.found.cycle.parameter / scale_, last_p = p, last_f = 0;
  double& slope = out.found.sensitivity;
  if (slope == 0) not_found("the multiplier does not move with the parameter");
  for (;;) {
    correct(u.get(), row.get(), p, newton_, out);
    const solve::ReplayLog::Answer read = read_off(u.get(), row.get(), [&](solve::ReplayLog::Answer& found) {
      double nearest = std::numeric_limits<double>::infinity();
      std::complex<double> closest;
      for (const auto& mu : problem_->multipliers())
        for (const auto& z : {mu, std::conj(mu)})
          if (std::abs(z - out.found.critical) < nearest) {
            nearest = std::abs(z - out.found.critical);
            closest = z;
          }
      found.numbers = {closest.real(), closest.imag()};
    });
    const std::complex<double> critical(read.numbers[0], read.numbers[1]);
    out.found.critical = critical;
    const double f = distance_of_multiplier(critical);
    if (out.solves > 1 && p != last_p) slope = (f - last_f) / (p - last_p);
    last_p = p;
    last_f = f;
    out.bracket = std::abs(f / slope);
    context_.results.progress(fmt::format("{}: {} states, {} {:.8g} {}, |mu| {:.8f}, {:.1f} s",
                                          context_.results.summary().name, system_->size(), options_.parameter.path, p,
                                          unit_, std::abs(critical), context_.results.seconds()));
    if (out.bracket <= continuation_.location_tolerance) return;
    p -= f / slope;
  }
}

// Secant on the slope dp/ds along the branch, by steps short enough to stay on it: on a coarse mesh the fold may lie
// far away. A step that leaves the validity of a film, or does not converge, is halved.
void CycleFollower::relocate_fold(core::Vector& u, Relocated& out) {
  core::Vector tangent = solve::any_tangent(*problem_, u.get()), row = core::duplicate(u.get()),
               rhs = core::duplicate(u.get());
  solve::parameter_row(*problem_, rhs.get());
  solve::NewtonOptions impatient = newton_;
  impatient.max_iterations = few_iterations;
  double longest = 0.3 * continuation_.max_step;
  // That of the fold on the other mesh; where none is known a first step of a hundredth of a clearance (see
  // state_weight()) shows it.
  double& curvature = out.found.sensitivity;
  double last_f = 0, step = 0;
  core::Vector last = core::duplicate(u.get());
  for (;;) {
    solve::weighted_row(*problem_, tangent.get(), row.get());
    for (int halvings = 0;; ++halvings) {
      double offset = 0;
      check(VecDot(row.get(), u.get(), &offset));
      try {
        correct(u.get(), row.get(), offset, step == 0 ? newton_ : impatient, out);
        break;
      } catch (const core::NotConverged&) {
        if (step == 0 || halvings == 6) throw;
      }
      step /= 2;
      longest = std::abs(step);
      check(VecWAXPY(u.get(), step, tangent.get(), last.get()));
    }
    const solve::ReplayLog::Answer read = read_off(u.get(), row.get(), [&](solve::ReplayLog::Answer& found) {
      (void)solve::solve_linear(*problem_, rhs.get(), tangent.get(), "tangent_");
      check(VecScale(tangent.get(), 1 / std::sqrt(solve::inner(*problem_, tangent.get(), tangent.get()))));
      found.vectors = {solve::ReplayLog::keep(newton_.replay_log, tangent.get())};
    });
    solve::ReplayLog::give(read.vectors.at(0), tangent.get());
    const double f = solve::last_entry(problem_->comm(), tangent.get());
    if (out.solves > 1 && f != last_f) curvature = (f - last_f) / step;
    const double next = curvature != 0 ? std::clamp(-f / curvature, -longest, longest) : 0.02 * continuation_.max_step;
    const double p = solve::last_entry(problem_->comm(), u.get());
    // The slope is linear in s near the fold, the parameter quadratic.
    out.bracket = std::abs(f * next / 2);
    context_.results.progress(fmt::format("{}: {} states, {} {:.8g} {}, slope {:.3g}, {:.1f} s",
                                          context_.results.summary().name, system_->size(), options_.parameter.path, p,
                                          unit_, f, context_.results.seconds()));
    if (out.solves > 1 && out.bracket <= continuation_.location_tolerance) return;
    check(VecCopy(u.get(), last.get()));
    check(VecAXPY(u.get(), next, tangent.get()));
    last_f = f;
    step = next;
  }
}

}  // namespace whirl::study
