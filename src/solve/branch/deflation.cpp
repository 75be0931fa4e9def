#include "whirl/solve/branch/deflation.hpp"

#include <cmath>
#include <limits>

#include "solve/branch/follower.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;

DeflatedProblem::DeflatedProblem(ExtendedProblem& problem, double power, double unit)
    : problem_(problem), power_(power), unit_(unit) {}

void DeflatedProblem::take_out(Vec u) {
  known_.push_back(copy(u));
}

double DeflatedProblem::square(Vec u, Vec known, Vec difference) const {
  check(VecCopy(u, difference));
  check(VecAXPY(difference, -1, known));
  return inner(problem_, difference, difference) / unit_;
}

double DeflatedProblem::distance(Vec u) const {
  double least = std::numeric_limits<double>::infinity();
  const core::Vector difference = core::duplicate(u);
  for (const auto& r : known_) least = std::min(least, square(u, r.get(), difference.get()));
  return std::sqrt(least);
}

double DeflatedProblem::factor(Vec u, Vec gradient) const {
  double m = 1;
  core::Vector difference = core::duplicate(u), weighted = core::duplicate(u);
  if (gradient) check(VecSet(gradient, 0.0));
  for (const auto& r : known_) {
    const double d2 = square(u, r.get(), difference.get());
    if (!(d2 > 0)) {
      // Every rank has the same sum over all of them.
      core::DomainError known("a solution that is known already");
      known.mark_agreed();
      throw known;
    }
    const double pole = std::pow(d2, -power_ / 2), one = pole + 1;
    m *= one;
    if (!gradient) continue;
    weighted_row(problem_, difference.get(), weighted.get());
    check(VecAXPY(gradient, -power_ * pole / (d2 * unit_ * one), weighted.get()));
  }
  if (gradient) check(VecScale(gradient, m));
  return m;
}

void DeflatedProblem::scale(Vec y, double by) const {
  const double last = last_entry(comm(), y);
  check(VecScale(y, by));
  set_last_entry(comm(), y, last);
}

void DeflatedProblem::residual(Vec u, Vec r) {
  const double m = factor(u, nullptr);
  problem_.residual(u, r);
  scale(r, m);
}

void DeflatedProblem::linearise(Vec u, Vec row) {
  if (!residual_) {
    residual_ = core::duplicate(u);
    gradient_ = core::duplicate(u);
    z_ = core::duplicate(u);
  }
  m_ = factor(u, gradient_.get());
  problem_.residual(u, residual_.get());
  set_last_entry(comm(), residual_.get(), 0);
  problem_.linearise(u, row);
  core::Vector rhs = copy(residual_.get());
  scale(rhs.get(), 1 / m_);
  problem_.solve(rhs.get(), z_.get());
}

void DeflatedProblem::multiply(Vec v, Vec y) {
  problem_.multiply(v, y);
  scale(y, m_);
  check(VecAXPY(y, dot(gradient_.get(), v), residual_.get()));
}

void DeflatedProblem::solve(Vec rhs, Vec x) {
  core::Vector scaled = copy(rhs);
  scale(scaled.get(), 1 / m_);
  problem_.solve(scaled.get(), x);
  const double along = dot(gradient_.get(), x), bend = dot(gradient_.get(), z_.get());
  if (1 + bend == 0) {
    core::NotConverged singular("the deflated equations are singular");
    singular.mark_agreed();
    throw singular;
  }
  check(VecAXPY(x, -along / (1 + bend), z_.get()));
}

std::vector<core::Vector> deflate(ExtendedProblem& problem, double unit, const std::vector<core::Vector>& known,
                                  const std::function<core::Vector(int)>& guess, const DeflationOptions& options,
                                  const std::function<std::vector<core::Vector>(Vec)>& copies) {
  core::require(!known.empty(), "deflation begins with a solution");
  DeflatedProblem deflated(problem, options.power, unit);
  const auto take_out = [&](Vec u) {
    deflated.take_out(u);
    if (!copies) return;
    for (const auto& other : copies(u))
      if (rounded(deflated.distance(other.get())) > options.separation) deflated.take_out(other.get());
  };
  for (const auto& u : known) take_out(u.get());
  const double parameter = last_entry(problem.comm(), known.front().get());
  core::Vector row = core::duplicate(known.front().get());
  parameter_row(problem, row.get());
  std::vector<core::Vector> found;
  const auto wanted = static_cast<std::size_t>(options.solutions);
  for (int k = 0; k < options.attempts && known.size() + found.size() < wanted; ++k) {
    core::Vector u = guess(k);
    if (!u) break;
    set_last_entry(problem.comm(), u.get(), parameter);
    // One more solution may lie near a guess that has led to one.
    while (known.size() + found.size() < wanted) {
      core::Vector trial = copy(u.get());
      if (!newton(deflated, trial.get(), row.get(), parameter, options.newton).converged) break;
      if (!newton(problem, trial.get(), row.get(), parameter, options.newton).converged) break;
      if (!(rounded(deflated.distance(trial.get())) > options.separation)) break;
      take_out(trial.get());
      found.push_back(std::move(trial));
    }
  }
  return found;
}

}  // namespace whirl::solve
