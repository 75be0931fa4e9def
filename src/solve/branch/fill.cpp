// Points between the ends of a step, where a picture of the branch bends.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solve/branch/follower.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;

namespace {

constexpr int most_halvings = 3;  // of a step
constexpr int most_beyond = 8;    // points between steps, over the number of steps
// A range below this part of its values is rounding.
constexpr double least_range = 1e-3;
// A branch that is born at a bifurcation is expected to reach so many longest steps.
constexpr double steps_of_born = 4;
// A solution that lies farther from the cubic than this part of the chord belongs to another branch.
constexpr double nearby = 0.25;

// Places in BranchMemory::ranges.
constexpr std::size_t of_parameter = 0, of_leading = 1, of_axes = 2;

void extend(std::pair<double, double>& range, double value) {
  range = {std::min(range.first, value), std::max(range.second, value)};
}

// Distance of a point from the line between two others, all seen from the first of these.
double from_chord(double x, double y, double to_x, double to_y) {
  const double length = to_x * to_x + to_y * to_y;
  const double part = length > 0 ? std::clamp((x * to_x + y * to_y) / length, 0.0, 1.0) : 0.0;
  return std::hypot(x - part * to_x, y - part * to_y);
}

bool knows_leading(const BranchPoint* p) {
  return p && !p->stability.distance.empty() && p->stability.neutral == 0;
}

// Second divided difference of the distance of the least stable value over three points.
double curvature(const BranchPoint& a, const BranchPoint& b, const BranchPoint& c) {
  const auto f = [](const BranchPoint& p) { return p.stability.distance[0]; };
  return ((f(c) - f(b)) / c.step - (f(b) - f(a)) / b.step) / (b.step + c.step);
}

}  // namespace

void Follower::widen(const State& s, const Curves& drawn) {
  auto& ranges = memory_.ranges;
  if (ranges.size() != of_axes + drawn.size()) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    ranges.assign(of_axes + drawn.size(), {infinite, -infinite});
    if (questions_.cycles) ranges[of_leading] = {-1, 0};  // pictures of multipliers show the unit circle
  }
  extend(ranges[of_parameter], s.point.parameter);
  if (knows_leading(&s.point)) extend(ranges[of_leading], s.point.stability.distance[0]);
  for (std::size_t k = 0; k < drawn.size(); ++k)
    for (const double value : drawn[k]) extend(ranges[of_axes + k], value);
}

double Follower::progress(const State& a, Vec direction) const {
  if (!natural_from(a)) return inner(problem_, a.tangent.get(), direction);
  return last_entry(problem_.comm(), direction) * (a.point.slope > 0 ? 1 : -1);
}

// Hermite's cubic, whose slopes are the tangents.
core::Vector Follower::cubic(const State& a, const State& b, double t) const {
  const double h = distance(a, b.u.get()), left = t * (1 - t) * (1 - t) * h / progress(a, a.tangent.get()),
               right = -t * t * (1 - t) * h / progress(a, b.tangent.get());
  core::Vector u = copy(a.u.get());
  check(VecAXPBY(u.get(), t * t * (3 - 2 * t), (1 + 2 * t) * (1 - t) * (1 - t), b.u.get()));
  check(VecAXPY(u.get(), left, a.tangent.get()));
  check(VecAXPY(u.get(), right, b.tangent.get()));
  return u;
}

// How far curves on the cubic between two solutions lie from their chords, in units of the picture as it will be when
// the branch has run through its range: ranges are taken to grow with the square root of what has been run through.
// The leading multiplier or eigenvalue on the cubic is unknown: the parabola through three points serves. Of the points
// on both sides the one that bends it less counts, so that corners are not sought ever closer.
double Follower::bend(const Gap& s, const Curves& first, const Curves& last) {
  const double whole = std::abs(options_.to - options_.from),
               seen = memory_.ranges[of_parameter].second - memory_.ranges[of_parameter].first,
               expected = memory_.born ? std::min(whole, steps_of_born * options_.max_step) : whole;
  const double growth = seen < expected ? std::sqrt(expected / seen) : 1, across = std::max(seen, expected);
  const auto size_of = [&](std::size_t k, double size_of_values) {
    const auto [low, high] = memory_.ranges[k];
    return growth * std::max(high - low, least_range * size_of_values);
  };
  const BranchPoint &a = s.a.point, &b = s.b.point;
  double bent = 0, leading_size = 0;
  if (knows_leading(s.before) && knows_leading(&a) && knows_leading(&b)) {
    bent = curvature(*s.before, a, b);
    if (knows_leading(s.after))
      if (const double other = curvature(a, b, *s.after); std::abs(other) < std::abs(bent) || other * bent < 0)
        bent = other * bent < 0 ? 0 : other;
    leading_size = size_of(of_leading, std::abs(b.stability.values[0]));
  }
  const double to_x = (b.parameter - a.parameter) / across;
  double most = 0;
  for (const double t : {1.0 / 3, 2.0 / 3}) {
    const core::Vector u = cubic(s.a, s.b, t);
    const double x = (last_entry(problem_.comm(), u.get()) - a.parameter) / across;
    const Curves here = questions_.drawn(u.get());
    for (std::size_t k = 0; k < here.size(); ++k) {
      const auto [low, high] = memory_.ranges[of_axes + k];
      const double size = size_of(of_axes + k, std::max(std::abs(low), std::abs(high)));
      for (std::size_t i = 0; size > 0 && i < here[k].size(); ++i)
        most =
            std::max(most, from_chord(x, (here[k][i] - first[k][i]) / size, to_x, (last[k][i] - first[k][i]) / size));
    }
    if (!(leading_size > 0)) continue;
    const double rise = b.stability.distance[0] - a.stability.distance[0],
                 y = rise * t - bent * b.step * b.step * t * (1 - t);
    most = std::max(most, from_chord(x, y / leading_size, to_x, rise / leading_size));
  }
  return most;
}

bool Follower::middle(const State& a, const State& b, State& to) {
  to = {cubic(a, b, 0.5), {}, a.point};
  core::Vector row = core::duplicate(to.u.get()), moved = copy(to.u.get()), chord = copy(b.u.get());
  if (natural_from(a))
    parameter_row(problem_, row.get());
  else
    weighted_row(problem_, a.tangent.get(), row.get());
  const NewtonResult result = correct(to.u.get(), row.get(), dot(row.get(), to.u.get()));
  if (!result.converged) return false;
  check(VecAXPY(moved.get(), -1, to.u.get()));
  check(VecAXPY(chord.get(), -1, a.u.get()));
  const double apart = inner(problem_, moved.get(), moved.get()), length = inner(problem_, chord.get(), chord.get());
  if (rounded(apart) > nearby * nearby * length) return false;
  to.point.newton_iterations = result.iterations;
  to.point.step = distance(a, to.u.get());
  try {
    inspect(to, a.tangent.get());
  } catch (const core::NotConverged&) {  // a singular matrix
    return false;
  }
  return !to.point.stability.unknown;
}

void Follower::halve(const Gap& s, const Curves& first, const Curves& last, int depth, std::vector<State>& inner) {
  const State &a = s.a, &b = s.b;
  if (depth == most_halvings || a.point.filled + static_cast<int>(inner.size()) >= a.point.steps() + most_beyond ||
      !(progress(a, b.tangent.get()) > 0.1 * progress(a, a.tangent.get())) ||
      !(rounded(bend(s, first, last)) > options_.picture_tolerance))
    return;
  State here;
  if (!middle(a, b, here)) return;
  // Values that crossed the border of stability and came back. A branch that was born at a bifurcation may have run
  // back into it, where counts mean nothing.
  const int count = a.point.stability.unstable();
  if (questions_.events && b.point.stability.unstable() == count && here.point.stability.unstable() != count &&
      std::ranges::none_of(memory_.met, [&](const auto& e) { return e.after == a.point.index; })) {
    if (memory_.born) {
      suspect(a, b, "values may cross the border of stability and return");
    } else {
      memory_.visited = true;
      around(a, here, b);
    }
  }
  const Curves drawn = questions_.drawn(here.u.get());
  widen(here, drawn);
  State rest = copy(b);
  rest.point.step = distance(here, b.u.get());
  halve({s.before, a, here, &rest.point}, first, drawn, depth + 1, inner);
  inner.push_back(copy(here));
  halve({&a.point, here, rest, s.after}, drawn, last, depth + 1, inner);
}

void Follower::renumber(const State& a, const std::vector<State>& inner) {
  const BranchPoint& before = memory_.before.point;
  const bool rising = a.point.parameter > before.parameter;
  const auto place = [&](LocatedEvent& event, Vec u) {
    if (event.after == a.point.index) {
      const double at = rounded(distance(a, u));
      event.after += static_cast<int>(
          std::ranges::count_if(inner, [&](const State& s) { return rounded(distance(a, s.u.get())) < at; }));
    } else if (memory_.before.u && event.after == before.index) {  // found late, in the step before
      event.after += static_cast<int>(std::ranges::count_if(
          memory_.between, [&](double p) { return rising ? p < event.parameter : p > event.parameter; }));
    }
  };
  for (Found& found : found_)
    if (auto* event = std::get_if<LocatedEvent>(&found.item.what)) place(*event, found.u.get());
  if (memory_.held) place(*memory_.held, memory_.held_u.get());
}

double Follower::fill(const State& a, State& b) {
  if (!questions_.drawn || !(options_.picture_tolerance > 0)) return b.point.step;
  const std::vector<double> warm = memory_.warm;  // steps go on as if there were no points between
  std::vector<State> inner;
  const Curves first = questions_.drawn(a.u.get()), last = questions_.drawn(b.u.get());
  widen(a, first);
  widen(b, last);
  halve({memory_.before.u ? &memory_.before.point : nullptr, a, b, nullptr}, first, last, 0, inner);
  memory_.warm = warm;
  renumber(a, inner);
  memory_.between.clear();
  const State* from = &a;
  for (State& s : inner) {
    s.point.index = b.point.index++;
    s.point.filled = ++b.point.filled;
    s.point.between = true;
    s.point.step = distance(*from, s.u.get());
    memory_.between.push_back(s.point.parameter);
    from = &s;
  }
  const double step = inner.empty() ? b.point.step : distance(*from, b.u.get());
  for (State& s : inner) found_.push_back({{s.point}, std::move(s.u)});
  return step;
}

}  // namespace whirl::solve
