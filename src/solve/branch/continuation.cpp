#include "whirl/solve/branch/continuation.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "solve/branch/follower.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;

double rounded(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) - 9);
  return std::round(x / unit) * unit;
}

State copy(const State& s) {
  return {copy(s.u.get()), copy(s.tangent.get()), s.point};
}

namespace {

const std::string turns_sharply = "the branch turns too sharply (a larger beta_1 admits it)";

}  // namespace

double arclength(const ExtendedProblem& problem, const State& a, Vec b) {
  core::Vector chord = copy(b);
  check(VecAXPY(chord.get(), -1, a.u.get()));
  return inner(problem, a.tangent.get(), chord.get());
}

NewtonResult Follower::correct_at(core::Vector& u, double parameter) {
  core::Vector row = core::duplicate(u.get());
  parameter_row(problem_, row.get());
  set_last_entry(problem_.comm(), u.get(), parameter);
  return correct(u.get(), row.get(), parameter);
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
  // Steps of the parameter come to a fold with tangents that have turned away from the chord, and look behind it.
  const double behind = options_.kind == Continuation::natural ? std::numbers::pi : 1.5 * beta_1();
  return within(product, 1, length, beta_1()) &&
         within(forward * inner(problem_, to.tangent.get(), chord.get()), 1, length, behind) &&
         within(product - forward * weight * tp * dp, 1 - weight * tp * tp, length - weight * dp * dp, options_.beta_2);
}

bool Follower::advance(const State& from, double ds, State& to, NewtonResult& result) {
  to.u = copy(from.u.get());
  check(VecAXPY(to.u.get(), natural_from(from) ? ds / std::abs(from.point.slope) : ds, from.tangent.get()));
  core::Vector row = core::duplicate(to.u.get());
  if (natural_from(from))
    parameter_row(problem_, row.get());
  else
    weighted_row(problem_, from.tangent.get(), row.get());
  result = correct(to.u.get(), row.get(), dot(row.get(), to.u.get()));
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
  if (rounded(turned) >= rounded(std::cos(std::min(2 * beta_1(), std::numbers::pi))) && on_course(from, to))
    return true;
  result.reason = turns_sharply;
  return false;
}

// The solution carried over is corrected at right angles to the branch: near a fold there may be none at its parameter.
// If the new branch has its slope or its unstable values on the other side there, an event lies within the change of
// the discretisation: behind this point if it has not been passed yet, else ahead, where it has been reported already.
bool Follower::correct_on_new_mesh(State& here, NewtonResult& result) {
  core::Vector along = copy(here.tangent.get()), row = core::duplicate(here.u.get());
  check(VecScale(along.get(), 1 / std::sqrt(inner(problem_, along.get(), along.get()))));
  weighted_row(problem_, along.get(), row.get());
  result = correct(here.u.get(), row.get(), dot(row.get(), here.u.get()));
  if (!result.converged) return false;
  const auto facts = [](const State& s) { return std::pair(s.point.stability.unstable(), s.point.slope > 0); };
  const auto old = facts(here);
  const bool known = !here.point.stability.unknown;
  inspect(here, along.get());
  if (!questions_.events || !known || here.point.stability.unknown || facts(here) == old) return true;
  const double step = here.point.step;
  for (double ds = rounded(step / 256); ds <= step; ds *= 4) {
    State other;
    NewtonResult tried;
    if (look_ahead(here, -ds, other, tried) && facts(other) == old) {
      State end = copy(here);
      end.point.step = arclength(problem_, other, here.u.get());
      events(nullptr, nullptr, other, end);
      return true;
    }
    if (look_ahead(here, ds, other, tried) && facts(other) == old) {
      here = std::move(other);
      here.point.step = step + ds;
      return true;
    }
  }
  suspect(here, here, "unstable values or the direction of the branch changed with the mesh");
  return true;
}

Follower::Follower(ExtendedProblem& problem, core::Vector u, const ContinuationOptions& options,
                   BranchQuestions questions, std::optional<Restart> restart)
    : problem_(problem),
      options_(options),
      questions_(std::move(questions)),
      newton_(problem, options_.newton),
      kind_(options_.kind),
      direction_(options_.to >= options_.from ? 1 : -1),
      ds_(options_.initial_step) {
  here_.u = std::move(u);
  if (!restart) return;
  here_.u = std::move(restart->u);
  here_.tangent = std::move(restart->tangent);
  here_.point = std::move(restart->point);
  ds_ = restart->step;
  memory_ = std::move(restart->memory);
  memory_.born = memory_.born || here_.point.index < 0;
  stage_ = Stage::advance;
}

std::optional<BranchItem> Follower::next() {
  while (found_.empty()) {
    if (stage_ == Stage::ended) return std::nullopt;
    if (stage_ == Stage::start)
      begin();
    else if (stage_ == Stage::adapt)
      adapt_here();
    else
      step();
  }
  taken_ = std::move(found_.front());
  found_.pop_front();
  if (taken_.u) taken_.item.u = taken_.u.get();
  warm_up();
  return taken_.item;
}

void Follower::finish(std::string reason, bool completed) {
  if (stage_ == Stage::ended) return;
  release_held();
  const int points = stage_ == Stage::start ? 0 : here_.point.index + 1;
  end_ = {std::move(reason), completed, points, stage_ == Stage::start ? options_.from : here_.point.parameter};
  stage_ = Stage::ended;
}

void Follower::begin() {
  const NewtonResult first = correct_at(here_.u, options_.from);
  if (!first.converged) return finish(fmt::format("no solution at the start of the branch: {}", first.reason), false);
  here_.point.newton_iterations = first.iterations;
  inspect(here_, nullptr);
  accept_point(here_.point.step);
  found_.push_back({{ResumePoint{here_.point, ds_, &memory_}, here_.u.get(), here_.tangent.get()}, {}});
  stage_ = Stage::renew;
  at_start_ = true;
}

// One step, with halved lengths where it fails, and what lies on it.
void Follower::step() {
  // Whoever had the resume point may have renewed its tangent.
  if (std::exchange(at_start_, false) && questions_.limit && !(questions_.limit(here_.u.get()) > 0)) {
    finish(questions_.why(here_.u.get()), false);
    end_.limited = true;
    return;
  }
  if (stage_ == Stage::renew) here_.point.slope = last_entry(problem_.comm(), here_.tangent.get());
  stage_ = Stage::advance;
  // The last point stands at the limit but for rounding, whose sign must not decide whether another one follows.
  const double margin = 1e-10 * std::max(std::abs(options_.to), std::abs(options_.to - options_.from));
  if (direction_ * (here_.point.parameter - options_.to) >= -margin)
    return finish("reached the end of its range", true);
  if (here_.point.steps() + 1 >= options_.max_points) return finish("reached the largest number of points", false);
  if (options_.back ? direction_ * rounded(here_.point.parameter - *options_.back) < 0
                    : direction_ * rounded(here_.point.parameter - options_.from) < -std::abs(options_.max_step))
    return finish("turned back beyond the start of its range", true);
  State next;
  NewtonResult result;
  BranchEnd limit;
  while (true) {
    bool ok = advance(here_, ds_, next, result);
    if (ok && direction_ * (next.point.parameter - options_.to) > margin) {
      // End exactly at the limit: the arclength that leads there, by one secant step, then natural continuation.
      State last;
      last.u = copy(next.u.get());
      const double fraction = (options_.to - here_.point.parameter) / (next.point.parameter - here_.point.parameter);
      check(VecAXPBY(last.u.get(), 1 - fraction, fraction, here_.u.get()));
      result = correct_at(last.u, options_.to);
      ok = result.converged;
      if (ok) {
        last.point = here_.point;
        last.point.step = distance(here_, last.u.get());
        last.point.newton_iterations = result.iterations;
        inspect(last, here_.tangent.get());
        next = std::move(last);
      }
    }
    limit = {};
    if (ok && questions_.limit && !(questions_.limit(next.u.get()) > 0) && !end_at_limit(here_, next, limit)) {
      result.reason = questions_.why(next.u.get());
      ok = false;
    }
    if (ok) break;
    ds_ = rounded(ds_ / 2);
    if (ds_ < options_.min_step && here_.point.index < 0 && !leaves_askew_ && result.reason == turns_sharply) {
      leaves_askew_ = true;
      ds_ = options_.initial_step;
      next = {};
      continue;
    }
    if (ds_ < options_.min_step)
      return finish(turns_back(here_) ? "the branch turns back at a fold, which natural continuation does not pass"
                                      : "the step fell below its minimum: " + result.reason,
                    false);
    next = {};
  }
  next.point.index = here_.point.index + 1;
  // With stability facts missing at this point alone (a branch that starts at a bifurcation) there is nothing to
  // compare with.
  const bool unknown = here_.point.stability.unknown || next.point.stability.unknown,
             comparable = !unknown && (!questions_.stability || !here_.point.stability.values.empty());
  if (questions_.events && unknown) suspect(here_, next, "the search for eigenvalues or multipliers did not converge");
  if (questions_.events && comparable)
    events(memory_.earlier ? &*memory_.earlier : nullptr, memory_.before.u ? &memory_.before : nullptr, here_, next);
  const double step = comparable ? fill(here_, next) : next.point.step;
  memory_.earlier.reset();
  if (memory_.before.u) memory_.earlier = std::move(memory_.before.point);
  memory_.before = std::move(here_);
  if (!comparable) forget_points();
  here_ = std::move(next);
  leaves_askew_ = false;
  const int k = result.effort;
  ds_ = rounded(std::min(options_.max_step, ds_ * (k <= 2 ? 2.0 : k == 3 ? 1.5 : k == 4 ? 1.1 : k == 5 ? 0.8 : 0.5)));
  ds_ = std::max(ds_, options_.min_step);
  accept_point(step);
  stage_ = Stage::adapt;
  if (limit.limited) {
    finish(questions_.why(here_.u.get()), false);
    end_.limited = true;
    end_.bracket = limit.bracket;
  }
}

void Follower::adapt_here() {
  // What is held back lies on this mesh.
  if (options_.adapt_every > 0 && here_.point.steps() % options_.adapt_every == 0 && !memory_.held &&
      problem_.adapt(here_.u, here_.tangent)) {
    forget_points();
    NewtonResult again;
    if (!correct_on_new_mesh(here_, again))
      return finish(fmt::format("no solution on the adapted mesh: {}", again.reason), false);
  }
  found_.push_back({{ResumePoint{here_.point, ds_, &memory_}, here_.u.get(), here_.tangent.get()}, {}});
  stage_ = Stage::renew;
}

BranchIterator::BranchIterator(ExtendedProblem& problem, core::Vector u, const ContinuationOptions& options,
                               BranchQuestions questions, std::optional<Restart> restart)
    : follower_(std::make_unique<Follower>(problem, std::move(u), options, std::move(questions), std::move(restart))) {}
BranchIterator::BranchIterator(BranchIterator&&) noexcept = default;
BranchIterator& BranchIterator::operator=(BranchIterator&&) noexcept = default;
BranchIterator::~BranchIterator() = default;

std::optional<BranchItem> BranchIterator::next() {
  return follower_->next();
}

void BranchIterator::stop(const std::string& reason) {
  follower_->finish(reason, false);
}

const BranchEnd& BranchIterator::end() const {
  return follower_->end();
}

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
  BranchQuestions questions = callbacks;
  questions.events = callbacks.events && callbacks.on_event;
  questions.zeros = callbacks.zeros && callbacks.on_zero;
  BranchIterator branch(problem, std::move(u), options, std::move(questions), std::move(restart));
  while (const auto item = branch.next()) {
    if (const auto* point = std::get_if<BranchPoint>(&item->what)) {
      if (callbacks.on_point) callbacks.on_point(*point, item->u);
    } else if (const auto* event = std::get_if<LocatedEvent>(&item->what)) {
      callbacks.on_event(*event, item->u);
    } else if (const auto* zero = std::get_if<LocatedZero>(&item->what)) {
      callbacks.on_zero(*zero, item->u);
    } else if (const auto* suspicion = std::get_if<Suspicion>(&item->what)) {
      if (callbacks.on_suspicion) callbacks.on_suspicion(*suspicion);
    } else if (const auto* resume = std::get_if<ResumePoint>(&item->what); callbacks.checkpoint) {
      if (!callbacks.checkpoint(*resume, item->u, item->tangent)) branch.stop("stopped on request");
    }
  }
  return branch.end();
}

}  // namespace whirl::solve
