#pragma once
// One branch on its way: steps here, events between two points beside it.

#include <algorithm>
#include <deque>
#include <functional>
#include <numbers>
#include <optional>

#include "whirl/solve/branch/continuation.hpp"

namespace whirl::solve {

using State = BranchState;

/// Ten significant digits: the last ones may differ between rank counts and must not decide anything.
[[nodiscard]] double rounded(double x);
[[nodiscard]] State copy(const State& s);
/// Arclength from a to b as the pseudo-arclength condition counts it: along the tangent at a.
[[nodiscard]] double arclength(const ExtendedProblem& problem, const State& a, Vec b);

class Follower {
public:
  Follower(ExtendedProblem& problem, core::Vector u, const ContinuationOptions& options, BranchQuestions questions,
           std::optional<Restart> restart);

  [[nodiscard]] std::optional<BranchItem> next();
  void finish(std::string reason, bool completed);
  [[nodiscard]] const BranchEnd& end() const { return end_; }

private:
  // Work is done in stages, each of which leaves items; the next one begins when these were taken.
  enum class Stage { start, advance, adapt, renew, ended };
  void begin();
  void step();
  void adapt_here();
  void meet(LocatedEvent found, core::Vector u);
  // Their mesh is gone, or they have nothing to compare with.
  void forget_points() { memory_.before = {}, memory_.earlier.reset(); }
  void accept_point(double step) {
    BranchPoint shown = here_.point;
    shown.step = step;
    found_.push_back({{std::move(shown), here_.u.get()}, {}});
  }
  // Tangent and stability at a corrected u; `along` gives the orientation (null: towards the end of the range).
  void inspect(State& s, Vec along);
  void look_at(State& s, Vec along);
  // Whatever others did with the problem meanwhile, or did not as they knew its outcome.
  void warm_up() { problem_.take_warm_start(memory_.warm); }
  NewtonResult correct(Vec u, Vec row, double offset) {
    warm_up();
    return newton_.solve(u, row, offset);
  }
  NewtonResult correct_at(core::Vector& u, double parameter);
  [[nodiscard]] bool on_course(const State& from, const State& to) const;
  // Where a force has kinks a branch leaves its bifurcation askew, at an angle that no shorter step makes smaller: its
  // first step may deviate by a right angle if no other way leads on.
  [[nodiscard]] double beta_1() const {
    return leaves_askew_ ? std::max(options_.beta_1, std::numbers::pi / 2) : options_.beta_1;
  }
  // The point at arclength ds from `from`; of natural continuation, at the parameter ds further on.
  bool advance(const State& from, double ds, State& to, NewtonResult& result);
  // The same, at a place whose stability is wanted.
  bool look_ahead(const State& from, double ds, State& to, NewtonResult& result) {
    return advance(from, ds, to, result) && !to.point.stability.unknown;
  }
  // A branch that leaves a bifurcation at right angles to the parameter begins with a step of arclength.
  [[nodiscard]] bool natural_from(const State& from) const {
    return kind_ == Continuation::natural && from.point.slope != 0;
  }
  // The point at a parameter between two points, seen from the first; none where the branch turns.
  bool between(const State& a, const State& b, double parameter, State& to);
  // How far b lies from a in the measure of advance().
  [[nodiscard]] double distance(const State& a, Vec b) const;
  // The branch ends where the limit of the callbacks is met between two points; false if that place cannot be found.
  bool end_at_limit(const State& a, State& b, BranchEnd& end);
  // Whether a branch that natural continuation cannot follow turns back just behind `here`: the fold is then reported.
  bool turns_back(const State& here);
  // After a change of the discretisation: the point near `here` on the branch of the new one, and what that changed.
  bool correct_on_new_mesh(State& here, NewtonResult& result);

  // All that lies between two points. With the points before a (null: none on this mesh), also what the count of
  // unstable values at a and b does not show.
  void events(const BranchPoint* first, const State* before, const State& a, const State& b);
  using Test = std::function<double(const State&)>;
  // The zero of a test function between two points, up to `tolerance` in the parameter; false if the location did not
  // converge, then `at` is the nearest point found.
  bool locate(const State& a, const State& b, const Test& test, double tolerance, LocatedEvent& found, State& at);
  bool search(const State& a, const State& b, const Test& test, double tolerance, LocatedEvent& found, State& at);
  // The same, refined by the callback where that can; `name` tells the event at a point near it.
  void pin_down(const State& a, const State& b, const Test& test, const std::function<void(const State&)>& name,
                LocatedEvent& found, State& at);
  void folds(const State& a, const State& b, int depth);
  [[nodiscard]] bool turns_beside(const State& a, const State& at) const;
  void release_held();
  void crossings(const State& a, const State& b, int depth);
  // From look to look of the options: what comes and goes between two points shows there.
  void crossings_by_looks(const State& a, const State& b);
  void zeros(const State& a, const State& b);
  void visits(const State& before, const State& a, const State& b, bool seen);
  [[nodiscard]] bool kinks(const BranchPoint& first, const State& a, const State& b, const State& last);
  void around(const State& a, State& middle, const State& b);
  bool split(const State& a, const State& b, State& middle, State& rest);
  void suspect(const State& a, const State& b, std::string why);

  // Points between those of a step, where a picture of the branch bends; gives b its index, and returns its arclength
  // from the last of them.
  double fill(const State& a, State& b);
  using Curves = std::vector<std::vector<double>>;
  // Two points with their neighbours, which may be unknown.
  struct Gap {
    const BranchPoint* before;
    const State &a, &b;
    const BranchPoint* after;
  };
  void widen(const State& s, const Curves& drawn);
  void halve(const Gap& s, const Curves& first, const Curves& last, int depth, std::vector<State>& inner);
  [[nodiscard]] double bend(const Gap& s, const Curves& first, const Curves& last);
  [[nodiscard]] bool middle(const State& a, const State& b, State& to);
  [[nodiscard]] core::Vector cubic(const State& a, const State& b, double part) const;
  // How much a direction leads on from a in the measure of distance().
  [[nodiscard]] double progress(const State& a, Vec direction) const;
  // Events lie behind the points that were filled in before them.
  void renumber(const State& a, const std::vector<State>& inner);

  // An item that waits, with its solution unless that is here_'s.
  struct Found {
    BranchItem item;
    core::Vector u;
  };

  ExtendedProblem& problem_;
  const ContinuationOptions options_;
  const BranchQuestions questions_;
  Newton newton_;
  Continuation kind_;
  int direction_;
  BranchMemory memory_;  // while events of a step are sought, folds and events are those of this step
  std::vector<std::pair<double, double>> last_folds_;
  std::vector<LocatedEvent> last_met_;
  Stage stage_ = Stage::start;
  State here_;
  bool leaves_askew_ = false;
  bool at_start_ = false;  // of the branch, whose first point was just taken
  double ds_;
  std::deque<Found> found_;
  Found taken_;
  BranchEnd end_;
};

}  // namespace whirl::solve
