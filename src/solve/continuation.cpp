#include "whirl/solve/continuation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "whirl/core/error.hpp"

namespace whirl::solve {
namespace {

using core::check;

// Ten significant digits: the last ones may differ between rank counts and must not decide anything.
double rounded(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) - 9);
  return std::round(x / unit) * unit;
}

struct State {
  core::Vector u, tangent;
  BranchPoint point;
};

core::Vector copy(Vec v) {
  core::Vector c = core::duplicate(v);
  check(VecCopy(v, c.get()));
  return c;
}

// Arclength from a to b as the pseudo-arclength condition counts it: along the tangent at a.
double arclength(const ExtendedProblem& problem, const State& a, Vec b) {
  core::Vector chord = copy(b);
  check(VecAXPY(chord.get(), -1, a.u.get()));
  return inner(problem, a.tangent.get(), chord.get());
}

class Follower {
public:
  Follower(ExtendedProblem& problem, const ContinuationOptions& options, const BranchCallbacks& callbacks)
      : problem_(problem),
        options_(options),
        callbacks_(callbacks),
        newton_(problem, options.newton),
        direction_(options.to >= options.from ? 1 : -1) {}

  BranchEnd run(core::Vector u, std::optional<Restart> restart);

private:
  // Tangent and stability at a corrected u; `along` gives the orientation (null: towards the end of the range).
  void inspect(State& s, Vec along);
  NewtonResult correct(Vec u, Vec row, double offset) { return newton_.solve(u, row, offset); }
  NewtonResult correct_at(core::Vector& u, double parameter);
  [[nodiscard]] bool on_course(const State& from, const State& to) const;
  // The point at arclength ds from `from`.
  bool advance(const State& from, double ds, State& to, NewtonResult& result);
  void events(const State& a, const State& b);
  using Test = std::function<double(const State&)>;
  // The zero of a test function between two points; false if the location did not converge, then `at` is the nearest
  // point found.
  bool locate(const State& a, const State& b, const Test& test, LocatedEvent& found, State& at);
  void crossings(const State& a, const State& b, int depth);

  ExtendedProblem& problem_;
  const ContinuationOptions& options_;
  const BranchCallbacks& callbacks_;
  Newton newton_;
  int direction_;
  double fold_ = 0, fold_span_ = 0;  // of the step whose events are sought: NaN without a located fold
};

NewtonResult Follower::correct_at(core::Vector& u, double parameter) {
  core::Vector row = core::duplicate(u.get());
  parameter_row(problem_, row.get());
  set_last_entry(problem_.comm(), u.get(), parameter);
  return correct(u.get(), row.get(), parameter);
}

void Follower::inspect(State& s, Vec along) {
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
  s.point.parameter = last_entry(problem_.comm(), s.u.get());
  s.point.slope = last_entry(problem_.comm(), s.tangent.get());
  s.point.stability = callbacks_.stability ? callbacks_.stability(s.u.get()) : Stability{};
}

// The angles between the predictor and the chord, in all unknowns and in those without the parameter. Steps below the
// minimum occur when an event is located; there rounding decides the direction of the chord.
bool Follower::on_course(const State& from, const State& to) const {
  if (std::abs(to.point.step) < options_.min_step) return true;
  core::Vector chord = copy(to.u.get());
  check(VecAXPY(chord.get(), -1, from.u.get()));
  const double weight = last_entry(problem_.comm(), problem_.weights()), dp = last_entry(problem_.comm(), chord.get()),
               tp = from.point.slope;
  const auto within = [&](double product, double a, double b, double limit) {
    return a <= 0 || b <= 0 || rounded(product / std::sqrt(a * b)) >= rounded(std::cos(limit));
  };
  const double forward = to.point.step >= 0 ? 1 : -1;
  const double product = forward * inner(problem_, from.tangent.get(), chord.get()),
               length = inner(problem_, chord.get(), chord.get());
  return within(product, 1, length, options_.beta_1) &&
         within(product - forward * weight * tp * dp, 1 - weight * tp * tp, length - weight * dp * dp, options_.beta_2);
}

bool Follower::advance(const State& from, double ds, State& to, NewtonResult& result) {
  to.u = copy(from.u.get());
  check(VecAXPY(to.u.get(), ds, from.tangent.get()));
  core::Vector row = core::duplicate(to.u.get());
  weighted_row(problem_, from.tangent.get(), row.get());
  double offset = 0;
  check(VecDot(row.get(), to.u.get(), &offset));
  result = correct(to.u.get(), row.get(), offset);
  if (!result.converged) return false;
  to.point = from.point;
  to.point.step = ds;
  to.point.newton_iterations = result.iterations;
  try {
    inspect(to, from.tangent.get());
  } catch (const core::NotConverged& error) {  // a singular matrix, at a branch point for one
    result.reason = error.what();
    return false;
  }
  const double turned = inner(problem_, from.tangent.get(), to.tangent.get());
  if (rounded(turned) >= rounded(std::cos(std::min(2 * options_.beta_1, std::numbers::pi))) && on_course(from, to))
    return true;
  result.reason = "the branch turns too sharply";
  return false;
}

// False position (Illinois variant) of a test function along the arclength from the point a.
bool Follower::locate(const State& a, const State& b, const Test& test, LocatedEvent& found, State& at) {
  double s0 = 0, s1 = b.point.step, f0 = test(a), f1 = test(b);
  const double dp = b.point.parameter - a.point.parameter;
  found.sensitivity = dp != 0 ? (f1 - f0) / dp : 0;
  found.bracket = std::abs(dp);
  at.u = copy(b.u.get());
  at.point = b.point;
  double last = b.point.parameter, last_f = f1;
  int side = 0;
  for (int k = 0; k < 30; ++k) {
    double s = (s0 * f1 - s1 * f0) / (f1 - f0);
    if (k > 12) s = (s0 + s1) / 2;
    s = rounded(std::clamp(s, std::min(s0, s1), std::max(s0, s1)));
    State trial;
    NewtonResult result;
    if (!advance(a, s, trial, result)) return false;
    const double f = test(trial);
    at = std::move(trial);
    found.parameter = at.point.parameter;
    // False position may creep: what the secant through the last two points says is left counts as well.
    const double moved = found.parameter - last;
    found.bracket = std::max(std::abs(moved), f != last_f ? std::abs(f / (f - last_f) * moved) : 0.0);
    // The slope near the zero, from the last two points that lie far enough apart to show one.
    if (std::abs(moved) > 1e-4 * std::abs(dp)) found.sensitivity = (f - last_f) / moved;
    if (f == 0 || rounded(found.bracket) <= options_.location_tolerance) return true;
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

// Values that crossed the border of stability between two points. One value or one complex pair is located directly;
// more than that is first separated by halving the step.
void Follower::crossings(const State& a, const State& b, int depth) {
  const int from = a.point.stability.unstable(), to = b.point.stability.unstable();
  if (from == to) return;
  const auto k = static_cast<std::size_t>(std::min(from, to));
  const auto split = [&] {
    State middle;
    NewtonResult result;
    if (depth >= 6 || !advance(a, rounded(b.point.step / 2), middle, result)) return false;
    crossings(a, middle, depth + 1);
    State rest;
    rest.u = copy(b.u.get());
    rest.tangent = copy(b.tangent.get());
    rest.point = b.point;
    rest.point.step = arclength(problem_, middle, b.u.get());
    crossings(middle, rest, depth + 1);
    return true;
  };
  if (std::abs(to - from) > 2 && split()) return;

  // A search for a few eigenvalues may return fewer at one point: those left out are no less stable than its last.
  const Test test = [k](const State& s) {
    const auto& d = s.point.stability.distance;
    return d.empty() ? -1.0 : d[std::min(k, d.size() - 1)];
  };
  LocatedEvent found{};
  State at;
  found.located = locate(a, b, test, found, at);
  const auto& values = at.point.stability.values;
  const std::complex<double> value = values.empty() ? 0.0 : values[std::min(k, values.size() - 1)];
  // At a fold of a self-excited cycle the critical multiplier meets the trivial one at +1, and round-off splits the
  // double value into a pair of the size of its square root.
  const bool real = std::abs(value.imag()) <= (callbacks_.cycles && value.real() > 0 ? 5e-3 : 1e-7) * std::abs(value);
  if (real && std::abs(to - from) == 2 && split()) return;
  found.critical = value;
  if (!real)
    found.event = callbacks_.cycles ? Event::neimark_sacker : Event::hopf;
  else if (callbacks_.cycles && value.real() < 0)
    found.event = Event::flip;
  else
    found.event = Event::branch_point;
  // A real value crossing at +1 (or 0) where the branch turns is the fold that is located as such. After a split the
  // two may lie on different sides of the middle.
  const double apart = std::abs(found.parameter - fold_);
  if (found.event == Event::branch_point && (a.point.slope * b.point.slope < 0 || apart <= 0.01 * fold_span_)) return;
  callbacks_.on_event(found, at.u.get());
}

void Follower::events(const State& a, const State& b) {
  fold_ = std::numeric_limits<double>::quiet_NaN();
  if (a.point.slope * b.point.slope < 0) {
    LocatedEvent found{};
    State at;
    found.event = callbacks_.cycles ? Event::cyclic_fold : Event::fold;
    found.located = locate(
        a, b, [](const State& s) { return s.point.slope; }, found, at);
    found.sensitivity = 0;
    if (found.located) {
      fold_ = found.parameter;
      fold_span_ = std::max(std::abs(a.point.parameter - fold_), std::abs(b.point.parameter - fold_));
    }
    callbacks_.on_event(found, at.u.get());
  }
  crossings(a, b, 0);
}

BranchEnd Follower::run(core::Vector u, std::optional<Restart> restart) {
  State here;
  double ds = options_.initial_step;
  if (restart) {
    here.u = std::move(restart->u);
    here.tangent = std::move(restart->tangent);
    here.point = restart->point;
    ds = restart->step;
  } else {
    const NewtonResult first = correct_at(u, options_.from);
    if (!first.converged)
      return {fmt::format("no solution at the start of the branch: {}", first.reason), false, 0, options_.from};
    here.u = std::move(u);
    here.point.newton_iterations = first.iterations;
    inspect(here, nullptr);
    if (callbacks_.on_point) callbacks_.on_point(here.point, here.u.get());
    if (callbacks_.checkpoint && !callbacks_.checkpoint(here.point, here.u.get(), here.tangent.get(), ds))
      return {"stopped on request", false, 1, options_.from};
  }

  const auto ended = [&](std::string reason, bool completed) {
    return BranchEnd{std::move(reason), completed, here.point.index + 1, here.point.parameter};
  };
  // The last point stands at the limit but for rounding, whose sign must not decide whether another one follows.
  const double margin = 1e-10 * std::max(std::abs(options_.to), std::abs(options_.to - options_.from));
  const auto beyond = [&](double p) { return direction_ * (p - options_.to) >= -margin; };
  while (here.point.index + 1 < options_.max_points) {
    if (beyond(here.point.parameter)) return ended("reached the end of its range", true);
    if (direction_ * rounded(here.point.parameter - options_.from) < -std::abs(options_.max_step))
      return ended("turned back beyond the start of its range", true);
    State next;
    NewtonResult result;
    bool ok = advance(here, ds, next, result);
    if (ok && direction_ * (next.point.parameter - options_.to) > margin) {
      // End exactly at the limit: the arclength that leads there, by one secant step, then natural continuation.
      State last;
      last.u = copy(next.u.get());
      const double fraction = (options_.to - here.point.parameter) / (next.point.parameter - here.point.parameter);
      check(VecAXPBY(last.u.get(), 1 - fraction, fraction, here.u.get()));
      result = correct_at(last.u, options_.to);
      ok = result.converged;
      if (ok) {
        last.point = here.point;
        last.point.step = arclength(problem_, here, last.u.get());
        last.point.newton_iterations = result.iterations;
        inspect(last, here.tangent.get());
        next = std::move(last);
      }
    }
    if (!ok) {
      ds = rounded(ds / 2);
      if (ds < options_.min_step) return ended("the step fell below its minimum: " + result.reason, false);
      continue;
    }
    next.point.index = here.point.index + 1;
    // With stability facts missing at this point alone (a branch that starts at a bifurcation) there is nothing to
    // compare with.
    const bool comparable = !callbacks_.stability || !here.point.stability.values.empty();
    if (callbacks_.on_event && comparable) events(here, next);
    here = std::move(next);
    const int k = result.iterations;
    ds = rounded(std::min(options_.max_step, ds * (k <= 2 ? 2.0 : k == 3 ? 1.5 : k == 4 ? 1.1 : k == 5 ? 0.8 : 0.5)));
    ds = std::max(ds, options_.min_step);
    if (callbacks_.on_point) callbacks_.on_point(here.point, here.u.get());
    if (options_.adapt_every > 0 && here.point.index % options_.adapt_every == 0 &&
        problem_.adapt(here.u, here.tangent)) {
      // The carried-over solution is corrected at its parameter, so that the next step starts from the branch of the
      // new mesh.
      core::Vector along = copy(here.tangent.get());
      const NewtonResult again = correct_at(here.u, here.point.parameter);
      if (!again.converged) return ended(fmt::format("no solution on the adapted mesh: {}", again.reason), false);
      inspect(here, along.get());
    }
    if (callbacks_.checkpoint && !callbacks_.checkpoint(here.point, here.u.get(), here.tangent.get(), ds))
      return ended("stopped on request", false);
  }
  if (beyond(here.point.parameter)) return ended("reached the end of its range", true);
  return ended("reached the largest number of points", false);
}

}  // namespace

Stability make_stability(std::vector<std::complex<double>> values,
                         const std::function<double(std::complex<double>)>& distance) {
  Stability s;
  s.values = std::move(values);
  std::stable_sort(s.values.begin(), s.values.end(),
                   [&](const auto& x, const auto& y) { return distance(x) > distance(y); });
  for (const auto& v : s.values) s.distance.push_back(distance(v));
  return s;
}

const char* name_of(Event event) {
  switch (event) {
    case Event::fold:
      return "fold";
    case Event::hopf:
      return "hopf";
    case Event::cyclic_fold:
      return "cyclic_fold";
    case Event::flip:
      return "flip";
    case Event::neimark_sacker:
      return "neimark_sacker";
    case Event::branch_point:
      return "branch_point";
  }
  return "";
}

BranchEnd follow_branch(ExtendedProblem& problem, core::Vector u, const ContinuationOptions& options,
                        const BranchCallbacks& callbacks, std::optional<Restart> restart) {
  return Follower(problem, options, callbacks).run(std::move(u), std::move(restart));
}

}  // namespace whirl::solve
