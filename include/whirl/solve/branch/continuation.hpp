#pragma once
// Pseudo-arclength continuation with step control, events and their location.

#include <algorithm>
#include <complex>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "whirl/solve/newton/extended_problem.hpp"
#include "whirl/solve/newton/newton.hpp"

namespace whirl::solve {

/// How a branch goes on from a point: over the arclength, which passes folds, or over the parameter, which ends there.
enum class Continuation { arclength, natural };

/// All numbers in units of the scaled parameter.
struct ContinuationOptions {
  Continuation kind = Continuation::arclength;
  double from = 0, to = 1;
  double initial_step = 0.1, min_step = 1e-4, max_step = 0.5;
  int max_points = 1000;
  /// Where a step that passes them looks for events as well, as at a point; rising or falling.
  std::vector<double> looks = {};
  /// Where a branch that turned back ends; beyond `from` by a step if absent.
  std::optional<double> back;
  int adapt_every = 5;  ///< accepted points between adaptations of the discretisation; 0 never
  /// A step is halved if the chord to the new point deviates from the predictor by more than beta_1 or, of arclength,
  /// from the tangent there by more than 1.5 beta_1, or the two from each other by more than 2 beta_1: beyond that a
  /// sharp bend is cut or the branch followed backwards. beta_2 bounds the deviation of the chord in the states alone,
  /// without the parameter; pi: any. [rad]. Source: Fey (1992); van de Vrande (2001), Sec. 3.3.
  double beta_1 = std::numbers::pi / 6, beta_2 = std::numbers::pi;
  double location_tolerance = 1e-6;  ///< of a bifurcation, in scaled parameter
  /// How far a curve of BranchQuestions::drawn may lie from the line between two points, in units of its picture;
  /// beyond that points are computed between them. 0: none.
  double picture_tolerance = 0;
  NewtonOptions newton;
};

/// Eigenvalues or multipliers of a point, the least stable first, each with its signed distance from the border of
/// stability: Re(lambda) [1/s] for eigenvalues, |mu| - 1 for multipliers. The trivial multiplier of an autonomous cycle
/// is left out.
struct Stability {
  std::vector<std::complex<double>> values;
  std::vector<double> distance;
  int neutral = 0;       ///< values on the border as far as rounding can tell; none of them counts as unstable
  int missed = 0;        ///< eigenvalues that a count found and the search did not; -1 if the count itself is not sure
  bool unknown = false;  ///< the search did not converge: no values, and nothing follows from their number
  /// Growing pairs (imag > 0) that belong to the mesh of a discretisation and not to what it stands for: not among
  /// `values`.
  std::vector<std::complex<double>> mesh_waves{};

  [[nodiscard]] int unstable() const {
    int n = 0;
    for (double d : distance) n += d > 0;
    return n;
  }
};
/// Sorts values by falling distance.
[[nodiscard]] Stability make_stability(std::vector<std::complex<double>> values,
                                       const std::function<double(std::complex<double>)>& distance);

enum class Event { fold, hopf, cyclic_fold, flip, neimark_sacker, branch_point };
[[nodiscard]] const char* name_of(Event event);

/// One accepted point.
struct BranchPoint {
  int index = 0;         ///< its row in a table of all points
  int filled = 0;        ///< how many of the points up to it lie between the ends of steps
  bool between = false;  ///< this one does
  double parameter = 0;  ///< scaled
  double slope = 0;      ///< scaled parameter per arclength: its sign changes at folds
  double step = 0;       ///< arclength from the previous point
  int newton_iterations = 0;
  Stability stability;
  std::vector<double> monitors;

  [[nodiscard]] int steps() const { return index - filled; }
};

struct LocatedEvent {
  Event event;
  double parameter = 0;           ///< scaled
  double bracket = 0;             ///< scaled width left by the location: last move, or what a secant says is left
  double sensitivity = 0;         ///< d(distance)/d(scaled parameter) along the branch; 0 for folds
  std::complex<double> critical;  ///< eigenvalue [1/s] or multiplier
  bool located = true;            ///< false: seen between two points, but the location did not converge
  bool refined = false;           ///< by the minimally augmented system; `bracket` is then the Newton step left
  double quadratic = 0;           ///< d^2 parameter/d arclength^2 of a refined fold: the branch lies above if positive
  int unstable_before = 0;        ///< unstable values just before it along the branch
  int unstable_after = 0;         ///< and just behind it
  double slope = 0;               ///< scaled parameter per arclength there: its sign tells on which side "behind" is
  int after = 0;                  ///< index of the last point before it

  /// Unstable values beside the critical one or pair.
  [[nodiscard]] int others_unstable() const { return std::min(unstable_before, unstable_after); }
};

/// A zero of one of a branch's monitors.
struct LocatedZero {
  std::size_t monitor = 0;  ///< its place among them
  double parameter = 0;     ///< scaled
  double bracket = 0;       ///< scaled width left by the location
  bool located = true;
};

/// A stretch of the branch on which events may lie that could not be resolved, in scaled parameters.
struct Suspicion {
  double from = 0, to = 0;
  std::string reason;
};

/// What a callback makes of an event that is known roughly.
struct Refined {
  core::Vector u;
  double parameter = 0;           ///< scaled
  double error = 0;               ///< scaled
  double quadratic = 0;           ///< of a fold
  std::complex<double> critical;  ///< eigenvalue or multiplier
};

/// What a continuation asks about the solutions that it finds; all collective.
struct BranchQuestions {
  /// Stability at u, called after linearise(u). Where it is unknown the branch goes on, and says between which points
  /// events may have been missed.
  std::function<Stability(Vec u)> stability;
  /// The event near u on the branch with the given tangent, to rounding; nothing if that fails. The problem may be left
  /// linearised anywhere.
  std::function<std::optional<Refined>(const LocatedEvent&, Vec u, Vec tangent)> refine;
  /// Smooth functions of a point whose zeros are located as well, called after linearise(u) with the tangent there; as
  /// many at every point.
  std::function<std::vector<double>(Vec u, Vec tangent)> monitors;
  /// Positive where the solution is one of the equations' validity (a film thick enough): the branch ends at its zero,
  /// which is located, or at a start where it is not positive. `why` says what the limit is.
  std::function<double(Vec u)> limit;
  std::function<std::string(Vec u)> why;
  /// What pictures show over the parameter, by their axes: [axis][curve]. Where a curve bends, points are computed
  /// between the ends of a step (ContinuationOptions::picture_tolerance). As many at every solution, and solutions that
  /// are not exact must do.
  std::function<std::vector<std::vector<double>>(Vec u)> drawn;
  bool cycles = false;  ///< names the events of cycles instead of those of equilibria
  bool events = true;   ///< looks for events between points
  bool zeros = true;    ///< and for zeros of the monitors
};

/// A point with its unit tangent.
struct BranchState {
  core::Vector u, tangent;
  BranchPoint point;
};

/// What a branch knows of the steps behind it, by which it judges the next one. Points are those of the present
/// discretisation.
struct BranchMemory {
  BranchState before;                  ///< the last point but one; without u if there is none
  std::optional<BranchPoint> earlier;  ///< the one before
  bool visited = false;                ///< the last step's crossings came from a closer look
  /// Folds of the last step: parameter, and how far the step reaches from there.
  std::vector<std::pair<double, double>> folds;
  std::vector<LocatedEvent> met;  ///< all that was found in it
  /// A crossing that is none if a fold follows, and its solution.
  std::optional<LocatedEvent> held;
  core::Vector held_u;
  std::vector<double> warm;  ///< of the problem, as the last look left it
  bool born = false;         ///< at a bifurcation, and not where the range begins
  /// Least and largest value so far of the parameter, of the least stable value's distance from the border of stability
  /// and of each axis of BranchQuestions::drawn.
  std::vector<std::pair<double, double>> ranges;
  std::vector<double> between;  ///< parameters of the points within the last step
};

/// Where to go on after an interruption. Without the memory, the next steps may miss what only several points show.
struct Restart {
  core::Vector u, tangent;
  double step = 0;
  BranchPoint point;
  BranchMemory memory;
};

/// A point from which the branch can be taken up again: after its discretisation was adapted.
struct ResumePoint {
  BranchPoint point;
  double next_step = 0;
  const BranchMemory* memory = nullptr;  ///< the branch's own
};

/// What is met on the way along a branch.
struct BranchItem {
  std::variant<BranchPoint, LocatedEvent, LocatedZero, Suspicion, ResumePoint> what;
  Vec u = nullptr;        ///< the solution there, rounded at a resume point; null for a suspicion
  Vec tangent = nullptr;  ///< of resume points; may be changed
};

struct BranchEnd {
  std::string reason;      ///< why the branch ended
  bool completed = false;  ///< reached the end of its range
  int points = 0;
  double parameter = 0;  ///< scaled, of the last point
  bool limited = false;  ///< at the zero of the callback `limit`,
  double bracket = 0;    ///< whose location left this scaled width
};

class Follower;

/// The branch through u (a guess at options.from, corrected there first) to options.to, item by item:
///
///     while (auto item = branch.next()) ...
///     branch.end().reason ...
///
/// Of each step first what lies on it (events, zeros, suspicions), then the points between its ends, then its point,
/// then what an adaptation of the discretisation passed over, then the resume point. Work is done in next() alone, so
/// that whoever stops asking stops the continuation. Decisions use integer counts and rounded values only: any number
/// of ranks takes the same steps. Collective on problem.comm(); `problem` must outlive it.
class BranchIterator {
public:
  BranchIterator(ExtendedProblem& problem, core::Vector u, const ContinuationOptions& options,
                 BranchQuestions questions, std::optional<Restart> restart = std::nullopt);
  BranchIterator(BranchIterator&&) noexcept;
  BranchIterator& operator=(BranchIterator&&) noexcept;
  ~BranchIterator();

  /// The next item, nothing at the end of the branch. Its vectors are this object's and live until the next call; the
  /// problem has the item's discretisation meanwhile and may be linearised anywhere.
  [[nodiscard]] std::optional<BranchItem> next();
  /// Ends the branch at its last point; next() returns what was still held back.
  void stop(const std::string& reason);
  /// How it ended; valid after next() has returned nothing.
  [[nodiscard]] const BranchEnd& end() const;

private:
  std::unique_ptr<Follower> follower_;
};

/// What a study hands over instead of asking for items; all collective.
struct BranchCallbacks : BranchQuestions {
  std::function<void(const BranchPoint&, Vec u)> on_point;
  std::function<void(const LocatedEvent&, Vec u)> on_event;
  std::function<void(const LocatedZero&, Vec u)> on_zero;
  /// Where events may have been missed.
  std::function<void(const Suspicion&)> on_suspicion;
  /// After each accepted point, with all that a restart needs; return false to stop.
  std::function<bool(const ResumePoint&, Vec u, Vec tangent)> checkpoint;
};

/// Calls back for every item of a BranchIterator. Collective.
BranchEnd follow_branch(ExtendedProblem& problem, core::Vector u, const ContinuationOptions& options,
                        const BranchCallbacks& callbacks, std::optional<Restart> restart = std::nullopt);

}  // namespace whirl::solve
