// Where a branch ends before the end of its range: at a limit of its solutions, and at folds that are not passed.

#include <algorithm>
#include <cmath>
#include <utility>

#include "solve/branch/follower.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

double Follower::distance(const State& a, Vec b) const {
  if (!natural_from(a)) return arclength(problem_, a, b);
  return (last_entry(problem_.comm(), b) - a.point.parameter) * (a.point.slope > 0 ? 1 : -1);
}

bool Follower::end_at_limit(const State& a, State& b, BranchEnd& end) {
  LocatedEvent found{};
  State at;
  const Test limit = [this](const State& s) { return questions_.limit(s.u.get()); };
  if (!locate(a, b, limit, options_.location_tolerance, found, at)) return false;
  const int index = b.point.index;
  b = std::move(at);
  b.point.index = index;
  end.limited = true;
  end.bracket = found.bracket;
  return true;
}

// A few steps of arclength from the last point that could be reached over the parameter.
bool Follower::turns_back(const State& here) {
  if (kind_ != Continuation::natural) return false;
  // The last point stands on the fold, a hair behind it, which the step to it has found.
  if (memory_.before.u && rounded(memory_.before.point.slope * here.point.slope) < 0) return true;
  kind_ = Continuation::arclength;
  bool turned = false;
  State from = copy(here);
  double ds = options_.max_step;
  for (int k = 0; k < 60 && !turned && ds >= options_.min_step &&
                  std::abs(from.point.parameter - here.point.parameter) <= options_.max_step;
       ++k) {
    State to;
    NewtonResult result;
    if (!advance(from, ds, to, result)) {
      ds = rounded(ds / 2);
      continue;
    }
    turned = rounded(from.point.slope * to.point.slope) < 0;
    if (turned && questions_.events) folds(from, to, 0);
    from = std::move(to);
    ds = std::min(2 * ds, options_.max_step);
  }
  kind_ = Continuation::natural;
  return turned;
}

}  // namespace whirl::solve
