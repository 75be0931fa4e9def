// What happens between two points of a branch: found, located, or at least suspected.

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/branch/follower.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {
namespace {

// Crossings of the border of stability by single values, each followed from one point to the other: which value became
// which is settled by nearness, the nearest pair first. Values well inside on both sides cannot have crossed.
struct Crossings {
  int out = 0, in = 0;
};

Crossings matched(const Stability& a, const Stability& b) {
  const std::size_t n =
      std::min({a.values.size(), b.values.size(), static_cast<std::size_t>(std::max(a.unstable(), b.unstable())) + 6});
  struct Pair {
    double apart;
    std::size_t i, j;
  };
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) pairs.push_back({rounded(std::abs(a.values[i] - b.values[j])), i, j});
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) { return x.apart < y.apart; });
  std::vector<bool> used_a(n, false), used_b(n, false);
  Crossings c;
  for (const Pair& p : pairs) {
    if (used_a[p.i] || used_b[p.j]) continue;
    used_a[p.i] = used_b[p.j] = true;
    const bool before = a.distance[p.i] > 0, after = b.distance[p.j] > 0;
    c.out += !before && after;
    c.in += before && !after;
  }
  return c;
}

// The two values beside the border of stability, and 1 or -1 as they lie in it: the signed distance of one that stays
// is negative. Those that all points know; none where their counts of unstable values differ.
struct Beside {
  std::size_t order;
  double sign;
};
std::vector<Beside> beside_border(std::initializer_list<const BranchPoint*> points) {
  const int count = (*points.begin())->stability.unstable();
  std::vector<Beside> found;
  for (const int k : {count - 1, count})
    if (std::ranges::all_of(points, [&](const BranchPoint* p) {
          return k >= 0 && p->stability.unstable() == count && static_cast<int>(p->stability.distance.size()) > k;
        }))
      found.push_back({static_cast<std::size_t>(k), k < count ? -1.0 : 1.0});
  return found;
}

// Where the parabola through (-h1, f1), (0, f0), (h2, f2) has its extremum, and its value there.
struct Extremum {
  double s = 0, value = 0;
  bool inside = false;
};

Extremum extremum(double h1, double f1, double f0, double h2, double f2) {
  const double left = (f0 - f1) / h1, right = (f2 - f0) / h2, curvature = (right - left) / (h1 + h2);
  const double slope = (left * h2 + right * h1) / (h1 + h2);
  if (curvature == 0) return {};
  Extremum e;
  e.s = -slope / (2 * curvature);
  e.value = f0 + e.s * (slope + e.s * curvature);
  e.inside = e.s > -h1 && e.s < h2;
  return e;
}

}  // namespace

bool Follower::split(const State& a, const State& b, State& middle, State& rest) {
  NewtonResult result;
  if (!look_ahead(a, rounded(b.point.step / 2), middle, result)) return false;
  rest = copy(b);
  rest.point.step = distance(middle, b.u.get());
  return true;
}

void Follower::suspect(const State& a, const State& b, std::string why) {
  found_.push_back({{Suspicion{a.point.parameter, b.point.parameter, std::move(why)}}, {}});
}

// A closer look at a stretch may lead to what was found there before.
void Follower::meet(LocatedEvent found, core::Vector u) {
  const auto same = [&](const LocatedEvent& other) {
    const double apart = std::max({found.bracket, other.bracket, options_.location_tolerance});
    return found.located && other.located && other.event == found.event && found.critical != 0.0 &&
           std::abs(other.parameter - found.parameter) <= apart &&
           std::abs(other.critical.real() - found.critical.real()) <= 1e-4 * std::abs(found.critical) &&
           std::abs(std::abs(other.critical.imag()) - std::abs(found.critical.imag())) <=
               1e-4 * std::abs(found.critical);
  };
  for (const auto* all : {&memory_.met, &last_met_})
    if (std::any_of(all->begin(), all->end(), same)) return;
  memory_.met.push_back(found);
  found_.push_back({{std::move(found)}, std::move(u)});
}

// A change of the slope's sign is a fold. Two of them in one step leave no such trace, but the cubic with the slopes
// and parameters of both ends shows them.
void Follower::folds(const State& a, const State& b, int depth) {
  if (a.point.slope * b.point.slope < 0) {
    LocatedEvent found{};
    State at;
    found.event = questions_.cycles ? Event::cyclic_fold : Event::fold;
    found.unstable_before = a.point.stability.unstable();
    found.unstable_after = b.point.stability.unstable();
    pin_down(
        a, b, [](const State& s) { return s.point.slope; }, [](const State&) {}, found, at);
    found.sensitivity = 0;
    found.slope = at.point.slope;
    if (found.located)
      memory_.folds.emplace_back(found.parameter, std::max(std::abs(a.point.parameter - found.parameter),
                                                           std::abs(b.point.parameter - found.parameter)));
    meet(found, std::move(at.u));
    return;
  }
  const double h = b.point.step, cosine = inner(problem_, a.tangent.get(), b.tangent.get());
  const double first = h * a.point.slope, last = h * b.point.slope / cosine,
               rise = b.point.parameter - a.point.parameter;
  // dp/dt = first + t (linear + t square), t = 0..1
  const double square = 3 * (first + last - 2 * rise), linear = last - first - square;
  const double t = square != 0 ? -linear / (2 * square) : -1;
  const double least = first + t * (linear + t * square), noise = 1e-9 * std::abs(h);
  if (!(t > 0 && t < 1) || rounded(least * (first > 0 ? 1 : -1)) > -noise) return;
  State middle, rest;
  if (depth < 6 && split(a, b, middle, rest)) {
    folds(a, middle, depth + 1);
    folds(middle, rest, depth + 1);
    return;
  }
  suspect(a, b, "the parameter may turn twice within a step");
}

// Values that crossed the border of stability between two points. One value or one complex pair is located directly;
// more than that, and crossings in both directions, are first separated by halving the step.
void Follower::crossings(const State& a, const State& b, int depth) {
  const int from = a.point.stability.unstable(), to = b.point.stability.unstable();
  const auto separate = [&] {
    State middle, rest;
    if (depth >= 6 || !split(a, b, middle, rest)) return false;
    crossings(a, middle, depth + 1);
    crossings(middle, rest, depth + 1);
    return true;
  };
  const Crossings both = matched(a.point.stability, b.point.stability);
  if (both.out > 0 && both.in > 0) {
    if (separate()) return;
    suspect(a, b, "values cross the border of stability in both directions at once");
  }
  if (from == to) return;
  if (std::abs(to - from) > 2) {
    if (separate()) return;
    suspect(a, b, "more than two values cross the border of stability at once");
  }

  // A count changes by one with a real eigenvalue: pairs without damping lie as near to the border, and do not cross.
  const bool single = !questions_.cycles && std::abs(to - from) == 1;
  const auto growing = [](const State& s) {
    const Stability& all = s.point.stability;
    std::size_t n = 0;
    for (std::size_t i = 0; i < all.values.size(); ++i) n += all.values[i].imag() == 0 && all.distance[i] > 0;
    return n;
  };
  const std::size_t rank = single ? std::min(growing(a), growing(b)) : static_cast<std::size_t>(std::min(from, to));
  // A search for a few eigenvalues may return fewer at one point: those left out are no less stable than its last.
  const auto crossing = [single, rank](const State& s) {
    const auto& values = s.point.stability.values;
    std::size_t last = values.size(), seen = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (single && values[i].imag() != 0) continue;
      last = i;
      if (seen++ == rank) break;
    }
    return last;
  };
  const Test test = [&crossing](const State& s) {
    const std::size_t i = crossing(s);
    return i < s.point.stability.distance.size() ? s.point.stability.distance[i] : -1.0;
  };
  LocatedEvent found{};
  found.unstable_before = from;
  found.unstable_after = to;
  State at;
  bool real = false;
  pin_down(
      a, b, test,
      [&](const State& here) {
        const auto& values = here.point.stability.values;
        const std::size_t i = crossing(here);
        found.critical = i < values.size() ? values[i] : 0.0;
        // At a fold of a self-excited cycle the critical multiplier meets the trivial one at +1, and round-off splits
        // the double value into a pair of the size of its square root. On a coarse mesh that is larger, but a pair
        // would change the count by two: one of these was taken for the trivial multiplier.
        const double split = std::abs(to - from) == 1 ? 0.1 : 5e-3;
        const double tolerance = questions_.cycles && found.critical.real() > 0 ? split : 1e-7;
        real = std::abs(found.critical.imag()) <= tolerance * std::abs(found.critical);
        if (!real)
          found.event = questions_.cycles ? Event::neimark_sacker : Event::hopf;
        else if (questions_.cycles && found.critical.real() < 0)
          found.event = Event::flip;
        else
          found.event = Event::branch_point;
      },
      found, at);
  found.slope = at.point.slope;
  // A real value changes the count by one, a pair by two: else another one crosses in this step.
  if (std::abs(to - from) == (real ? 2 : 1) && separate()) return;
  // A real value crossing at +1 (or 0) where the branch turns is the fold that is located as such. After a split the
  // two may lie on different sides of the middle.
  const auto is_it = [&](const auto& fold) { return std::abs(found.parameter - fold.first) <= 0.01 * fold.second; };
  if (found.event == Event::branch_point) {
    if (a.point.slope * b.point.slope < 0 || std::any_of(memory_.folds.begin(), memory_.folds.end(), is_it) ||
        std::any_of(last_folds_.begin(), last_folds_.end(), is_it))
      return;
    if (turns_beside(a, at)) {
      memory_.held = found;
      memory_.held_u = std::move(at.u);
      return;
    }
  }
  meet(found, std::move(at.u));
}

// Whether the branch is about to turn right behind `at`: a multiplier passes +1 at the fold itself only as exactly as
// the discretisation conserves it, and may do so in the step before. The slope is linear there, the parameter
// quadratic.
bool Follower::turns_beside(const State& a, const State& at) const {
  const double change = at.point.slope - a.point.slope;
  if (change == 0) return false;
  const double to_turn = -at.point.slope * arclength(problem_, a, at.u.get()) / change;
  return std::abs(at.point.slope * to_turn / 2) <= 0.01 * std::abs(at.point.parameter - a.point.parameter);
}

void Follower::zeros(const State& a, const State& b) {
  for (std::size_t k = 0; k < std::min(a.point.monitors.size(), b.point.monitors.size()); ++k) {
    if (!(a.point.monitors[k] * b.point.monitors[k] < 0)) continue;
    LocatedEvent found{};
    State at;
    const bool located = locate(
        a, b, [k](const State& s) { return s.point.monitors[k]; }, options_.location_tolerance, found, at);
    found_.push_back({{LocatedZero{k, found.parameter, found.bracket, located}}, std::move(at.u)});
  }
}

// A value that comes to the border and goes again leaves the same count at all points. Its distance over three of them
// is a parabola; where that comes to less than half the distance of its nearest point, the branch is looked at there.
void Follower::visits(const State& before, const State& a, const State& b, bool seen) {
  for (const auto& [order, sign] : beside_border({&before.point, &a.point, &b.point})) {
    const auto distance = [order = order, sign = sign](const State& s) {
      return sign * s.point.stability.distance[order];
    };
    double h1 = a.point.step, h2 = b.point.step, f1 = distance(before), f0 = distance(a), f2 = distance(b);
    for (int attempt = 0; attempt < 5; ++attempt) {
      const Extremum peak = extremum(h1, f1, f0, h2, f2);
      const double nearest = std::max({f1, f0, f2});
      if (!peak.inside || (seen && peak.s < 0) || !(rounded(peak.value) > rounded(nearest / 2))) break;
      State here;
      NewtonResult result;
      if (attempt == 4 || !look_ahead(a, rounded(peak.s), here, result)) {
        suspect(before, b, "a value comes to the border of stability and may cross it and return");
        break;
      }
      const double f = distance(here);
      if (f > 0) {
        memory_.visited = peak.s > 0;
        around(peak.s < 0 ? before : a, here, peak.s < 0 ? a : b);
        break;
      }
      if (peak.s < 0) {
        h1 = -peak.s, f1 = f;
      } else {
        h2 = peak.s, f2 = f;
      }
    }
  }
}

// Two values that pass each other make a kink instead: there the lines through the points on either side meet.
// Logarithms of moduli are nearly straight where values grow by the same factor from point to point.
bool Follower::kinks(const BranchPoint& first, const State& a, const State& b, const State& last) {
  const int count = a.point.stability.unstable();
  for (const auto& [order, sign] : beside_border({&first, &a.point, &b.point, &last.point})) {
    const auto height = [&, order = order, sign = sign](const BranchPoint& p) {
      const double d = p.stability.distance[order];
      return sign * (questions_.cycles ? std::log(std::max(1 + d, 1e-300)) : d);
    };
    const double h = b.point.step, f0 = height(a.point), f1 = height(b.point);
    const double rise = (f0 - height(first)) / a.point.step, fall = (height(last.point) - f1) / last.point.step;
    if (!(rise > 0 && fall < 0)) continue;
    const double s = (f1 - fall * h - f0) / (rise - fall), peak = f0 + rise * s;
    if (!(s > 0 && s < h) || !(rounded(peak) > rounded(std::max(f0, f1) / 2))) continue;
    State here;
    NewtonResult result;
    if (!look_ahead(a, rounded(s), here, result)) {
      suspect(a, b, "values pass each other near the border of stability where no point could be computed");
      continue;
    }
    if (here.point.stability.unstable() != count) {
      around(a, here, b);
      return true;
    }
    // The lines overshoot a rounded peak; what remains on the border where they meet cannot be told.
    if (std::abs(height(here.point)) < 0.02 * std::abs(std::max(f0, f1)))
      suspect(a, b, "values pass each other at the border of stability and may cross it");
  }
  return false;
}

// Crossings between two points and one between them.
void Follower::around(const State& a, State& middle, const State& b) {
  State rest = copy(b);
  rest.point.step = distance(middle, b.u.get());
  middle.point.step = distance(a, middle.u.get());
  middle.point.index = a.point.index;
  crossings(a, middle, 0);
  crossings(middle, rest, 0);
}

// The branch did not turn after all.
void Follower::release_held() {
  if (memory_.held) meet(*memory_.held, std::move(memory_.held_u));
  memory_.held.reset();
}

void Follower::events(const BranchPoint* first, const State* before, const State& a, const State& b) {
  last_folds_ = std::exchange(memory_.folds, {});
  last_met_ = std::exchange(memory_.met, {});
  folds(a, b, 0);
  if (memory_.folds.empty()) release_held();
  memory_.held.reset();
  crossings_by_looks(a, b);
  if (questions_.zeros) zeros(a, b);
  bool seen = std::exchange(memory_.visited, false);  // between `before` and a
  if (first && before && !seen) seen = kinks(*first, *before, a, b);
  if (before) visits(*before, a, b, seen);
}

}  // namespace whirl::solve
