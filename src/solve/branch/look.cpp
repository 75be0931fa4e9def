// A look at a solution: tangent, stability, monitors; and where between two points a test function of them is zero.
// What a replay log keeps of looks and locations.

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/branch/follower.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;

namespace {

// A point, what a look at it found and what that left: counts, values, monitors and warm start; the tangent.
ReplayLog::Answer pack(const ReplayLog& replay_log, const State& s, const std::vector<double>& warm) {
  const Stability& all = s.point.stability;
  std::vector<double> out{static_cast<double>(all.values.size()),
                          static_cast<double>(all.distance.size()),
                          static_cast<double>(s.point.monitors.size()),
                          static_cast<double>(warm.size()),
                          static_cast<double>(all.neutral),
                          s.point.step,
                          static_cast<double>(s.point.newton_iterations),
                          static_cast<double>(all.missed),
                          static_cast<double>(all.mesh_waves.size()),
                          all.unknown ? 1.0 : 0.0};
  for (const auto* list : {&all.values, &all.mesh_waves})
    for (const auto& v : *list) out.insert(out.end(), {v.real(), v.imag()});
  for (const auto& list : {all.distance, s.point.monitors, warm}) out.insert(out.end(), list.begin(), list.end());
  return {std::move(out), {}, {ReplayLog::keep(&replay_log, s.tangent.get())}};
}

void unpack(const ReplayLog::Answer& answer, State& s, std::vector<double>& warm) {
  const double* at = answer.numbers.data();
  const auto next = [&at](double n) {
    const double* begin = std::exchange(at, at + static_cast<std::ptrdiff_t>(n));
    return std::vector<double>(begin, at);
  };
  const std::vector<double> counts = next(10);
  s.point.stability = {};
  const auto complex = [&next](double n) {
    std::vector<std::complex<double>> out;
    const std::vector<double> parts = next(2 * n);
    for (std::size_t k = 0; k < parts.size(); k += 2) out.emplace_back(parts[k], parts[k + 1]);
    return out;
  };
  s.point.stability.values = complex(counts[0]);
  s.point.stability.mesh_waves = complex(counts[8]);
  s.point.stability.distance = next(counts[1]);
  s.point.monitors = next(counts[2]);
  warm = next(counts[3]);
  s.point.stability.neutral = static_cast<int>(counts[4]);
  s.point.step = counts[5];
  s.point.newton_iterations = static_cast<int>(counts[6]);
  s.point.stability.missed = static_cast<int>(counts[7]);
  s.point.stability.unknown = counts[9] > 0;
  s.tangent = core::duplicate(s.u.get());
  ReplayLog::give(answer.vectors.at(0), s.tangent.get());
}

}  // namespace

void Follower::inspect(State& s, Vec along) {
  if (ReplayLog* replay_log = options_.newton.replay_log) {
    const std::vector<double> question{core::norm(s.u.get()), last_entry(problem_.comm(), s.u.get()),
                                       along ? 1.0 : 0.0};
    const auto found = replay_log->ask("look", question, [&](const ReplayLog::Answer&) {
      look_at(s, along);
      return pack(*replay_log, s, memory_.warm);
    });
    unpack(found, s, memory_.warm);
  } else {
    look_at(s, along);
  }
  s.point.parameter = last_entry(problem_.comm(), s.u.get());
  s.point.slope = last_entry(problem_.comm(), s.tangent.get());
}

// Trials that led there are of no use any more.
bool Follower::locate(const State& a, const State& b, const Test& test, double tolerance, LocatedEvent& found,
                      State& at) {
  ReplayLog* replay_log = options_.newton.replay_log;
  if (!replay_log) return search(a, b, test, tolerance, found, at);
  const std::vector<double> question{core::norm(a.u.get()), core::norm(b.u.get()), b.point.step, tolerance};
  const auto answer = replay_log->ask("locate", question, [&](const ReplayLog::Answer&) {
    const bool done = search(a, b, test, tolerance, found, at);
    ReplayLog::Answer out = pack(*replay_log, at, memory_.warm);
    out.vectors.push_back(ReplayLog::keep(replay_log, at.u.get()));
    out.numbers.insert(out.numbers.end(), {done ? 1.0 : 0.0, found.parameter, found.bracket, found.sensitivity});
    return out;
  });
  at.u = copy(b.u.get());
  at.point = a.point;
  unpack(answer, at, memory_.warm);
  const double* facts = answer.numbers.data() + answer.numbers.size() - 4;
  ReplayLog::give(answer.vectors.at(1), at.u.get());
  at.point.parameter = last_entry(problem_.comm(), at.u.get());
  at.point.slope = last_entry(problem_.comm(), at.tangent.get());
  found.parameter = facts[1];
  found.bracket = facts[2];
  found.sensitivity = facts[3];
  return facts[0] != 0;
}

// False position (Illinois variant) of a test function along the arclength from the point a.
bool Follower::search(const State& a, const State& b, const Test& test, double tolerance, LocatedEvent& found,
                      State& at) {
  double s0 = 0, s1 = b.point.step, f0 = test(a), f1 = test(b);
  const double dp = b.point.parameter - a.point.parameter;
  found.sensitivity = dp != 0 ? (f1 - f0) / dp : 0;
  found.bracket = std::abs(dp);
  found.parameter = b.point.parameter;
  at = copy(b);
  double last = b.point.parameter, last_f = f1, p0 = a.point.parameter;
  int side = 0;
  for (int k = 0; k < 30; ++k) {
    double s = (s0 * f1 - s1 * f0) / (f1 - f0);
    if (k > 12) s = (s0 + s1) / 2;
    s = rounded(std::clamp(s, std::min(s0, s1), std::max(s0, s1)));
    State trial;
    NewtonResult result;
    // Where a bend is too sharp for a step, as beside a row of a table, the parameter still leads there.
    if (!look_ahead(a, s, trial, result)) {
      if (!between(a, b, a.point.parameter + s / b.point.step * dp, trial)) return false;
      s = trial.point.step;
    }
    const double f = test(trial);
    at = std::move(trial);
    found.parameter = at.point.parameter;
    const double moved = found.parameter - last, secant = f != last_f ? std::abs(f / (f - last_f) * moved) : 0.0;
    if (f * f1 < 0) p0 = last;
    // A search that creeps has left what the secant says; one across a jump, what its ends enclose.
    found.bracket = std::min(std::max(std::abs(moved), secant), std::abs(found.parameter - p0));
    // The slope near the zero, from the last two points that lie far enough apart to show one.
    if (std::abs(moved) > 1e-4 * std::abs(dp)) found.sensitivity = (f - last_f) / moved;
    if (f == 0 || rounded(found.bracket) <= tolerance) return true;
    last = found.parameter;
    last_f = f;
    if (f * f1 < 0) {
      s0 = s1, f0 = f1;
      side = 0;
    } else {
      if (side == 1) f0 /= 2;
      side = 1;
    }
    s1 = s, f1 = f;
  }
  return false;
}

// The event roughly, then to rounding by the callback; by false position alone where that leads elsewhere.
void Follower::pin_down(const State& a, const State& b, const Test& test, const std::function<void(const State&)>& name,
                        LocatedEvent& found, State& at) {
  found.after = a.point.index;
  if (questions_.refine) {
    const double rough = 1e-2 * std::abs(b.point.parameter - a.point.parameter);
    found.located = locate(a, b, test, std::max(options_.location_tolerance, rough), found, at);
    name(at);
    if (found.located) {
      warm_up();
      std::optional<Refined> refined = questions_.refine(found, at.u.get(), at.tangent.get());
      const double h = b.point.step, s = refined ? distance(a, refined->u.get()) : 0;
      if (refined && s > std::min(0.0, h) - 0.1 * std::abs(h) && s < std::max(0.0, h) + 0.1 * std::abs(h)) {
        State exact;
        exact.u = std::move(refined->u);
        exact.point = at.point;
        try {
          inspect(exact, a.tangent.get());
          at = std::move(exact);
          found.parameter = refined->parameter;
          found.bracket = refined->error;
          found.critical = refined->critical;
          found.quadratic = refined->quadratic;
          found.refined = true;
          return;
        } catch (const core::NotConverged&) {
          // the row of a's tangent makes the matrix singular here: as without refinement
        }
      }
    }
  }
  found.located = locate(a, b, test, options_.location_tolerance, found, at);
  name(at);
}

void Follower::look_at(State& s, Vec along) {
  warm_up();
  core::Vector row = core::duplicate(s.u.get()), rhs = core::duplicate(s.u.get());
  if (along)
    weighted_row(problem_, along, row.get());
  else
    parameter_row(problem_, row.get());
  problem_.linearise(s.u.get(), row.get());
  check(VecSet(rhs.get(), 0.0));
  set_last_entry(problem_.comm(), rhs.get(), along ? 1.0 : static_cast<double>(direction_));
  s.tangent = core::duplicate(s.u.get());
  newton_.solve_linear(rhs.get(), s.tangent.get());
  check(VecScale(s.tangent.get(), 1 / std::sqrt(inner(problem_, s.tangent.get(), s.tangent.get()))));
  s.point.stability = questions_.stability ? questions_.stability(s.u.get()) : Stability{};
  if (questions_.monitors) s.point.monitors = questions_.monitors(s.u.get(), s.tangent.get());
  memory_.warm = problem_.warm_start();
}

bool Follower::between(const State& a, const State& b, double parameter, State& to) {
  const double rise = b.point.parameter - a.point.parameter;
  if (!(a.point.slope * rise > 0 && b.point.slope * rise > 0)) return false;
  const double part = (parameter - a.point.parameter) / rise;
  to = {copy(b.u.get()), {}, a.point};
  check(VecAXPBY(to.u.get(), 1 - part, part, a.u.get()));
  const NewtonResult result = correct_at(to.u, parameter);
  if (!result.converged) return false;
  to.point.newton_iterations = result.iterations;
  to.point.step = distance(a, to.u.get());
  if (!(to.point.step * b.point.step > 0)) return false;
  try {
    inspect(to, a.tangent.get());
  } catch (const core::NotConverged&) {  // a singular matrix
    return false;
  }
  return !to.point.stability.unknown;
}

void Follower::crossings_by_looks(const State& a, const State& b) {
  const double rise = b.point.parameter - a.point.parameter;
  std::vector<double> looks;
  for (const double at : options_.looks)
    if (const double part = rounded((at - a.point.parameter) / rise); part > 0 && part < 1) looks.push_back(at);
  std::ranges::sort(looks, [rise](double x, double y) { return rise > 0 ? x < y : x > y; });
  if (looks.empty()) return crossings(a, b, 0);
  State last = copy(a), here;
  for (const double at : looks) {
    if (!between(last, b, at, here)) continue;
    crossings(last, here, 0);
    last = std::move(here);
  }
  State end = copy(b);
  end.point.step = distance(last, b.u.get());
  crossings(last, end, 0);
}

}  // namespace whirl::solve
