#include "transient/steps/newmark.hpp"

#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/core/local_part.hpp"

namespace whirl::transient {

using core::check;
using Eigen::VectorXd;

namespace {

constexpr int most_newton = 12, most_fixed_point = 100;
// Of a step, in which rates are found: its error is that part of what trapezoids lose, and rounding is far below.
constexpr double rate_part = 1e-6;

}  // namespace

NewmarkSteps::NewmarkSteps(Equations& equations, bool linearised, bool regular, double tolerance)
    : equations_(equations),
      linearised_(linearised),
      tolerance_(tolerance),
      matrix_(equations.make_matrix()),
      solver_(equations.make_solver("newmark_")),
      regular_(regular) {
  for (core::Vector* v : {&rate_, &end_, &end_rate_, &f_, &change_, &consistent_}) *v = equations.make_state();
  if (linearised) rates_ = equations.make_matrix();
}

void NewmarkSteps::set_rate(double length, Vec u, Vec rate) {
  check(VecWAXPY(end_rate_.get(), -1, u, end_.get()));
  check(VecAXPBY(end_rate_.get(), -kept(), sigma(length), rate));
}

bool NewmarkSteps::solve(double time, double length, Vec u, Vec rate) {
  if (!linearised_) return newton(time, length, u, rate);
  const double to = time + length;
  check(VecCopy(u, end_.get()));
  // F + dF/du du + dF/du' (2/h du - 2 r_0) = 0, the step of Euler with r_0 once.
  equations_.residual(to, u, rate, f_.get());
  equations_.jacobian(to, u, rate, 1, sigma(length), matrix_.get());
  equations_.jacobian(to, u, rate, 0, 1, rates_.get());
  check(MatMult(rates_.get(), rate, change_.get()));
  check(VecAXPY(f_.get(), -(1 + kept()), change_.get()));
  if (!equations_.solve(solver_.get(), matrix_.get(), f_.get(), change_.get())) return false;
  check(VecAXPY(end_.get(), -1, change_.get()));
  set_rate(length, u, rate);
  return true;
}

bool NewmarkSteps::newton(double time, double length, Vec u, Vec rate) {
  const double to = time + length;
  check(VecCopy(u, end_.get()));
  check(VecAXPY(end_.get(), length, rate));
  double last = 0;
  for (int k = 0; k < most_newton; ++k) {
    set_rate(length, u, rate);
    equations_.residual(to, end_.get(), end_rate_.get(), f_.get());
    equations_.jacobian(to, end_.get(), end_rate_.get(), 1, sigma(length), matrix_.get());
    if (!equations_.solve(solver_.get(), matrix_.get(), f_.get(), change_.get())) return false;
    check(VecAXPY(end_.get(), -1, change_.get()));
    double moved = 0;
    check(VecNorm(change_.get(), NORM_2, &moved));
    moved /= std::sqrt(static_cast<double>(equations_.system().size()));
    if (!std::isfinite(moved)) return false;
    if (moved <= tolerance_) {
      set_rate(length, u, rate);
      return true;
    }
    if (k > 1 && moved > last) return false;
    last = moved;
  }
  return false;
}

// r_0, or a first step by Euler's method.
void NewmarkSteps::begin(double time, double wanted, Vec u) {
  if (regular_) {
    try {
      return equations_.rate(time, u, rate_.get());
    } catch (const core::NotConverged&) {
      regular_ = false;  // no row is zero, but some depend on each other
    }
  }
  euler_ = true;
  check(VecSet(rate_.get(), 0));
  const double e = rate_part * wanted;
  try {
    if (!newton(time, e, u, rate_.get())) return;
    check(VecCopy(end_.get(), consistent_.get()));
    if (!newton(time + e, e, consistent_.get(), rate_.get())) return;
  } catch (const core::DomainError&) {
    return;
  }
  check(VecCopy(end_rate_.get(), rate_.get()));
  euler_ = false;
}

Taken NewmarkSteps::step(double time, double wanted, Vec u) {
  euler_ = false;
  if (!has_rate_) begin(time, wanted, u);
  has_rate_ = true;
  const Taken taken = take_step(wanted, 1, [&](double h) -> std::optional<double> {
    return solve(time, h, u, rate_.get()) ? std::optional(0.0) : std::nullopt;
  });
  check(VecCopy(end_.get(), u));
  check(VecCopy(end_rate_.get(), rate_.get()));
  return {taken.length, taken.length, taken.rejected, taken.why};
}

NewmarkFixedPointSteps::NewmarkFixedPointSteps(Equations& equations, bool regular, double tolerance)
    : NewmarkSteps(equations, false, regular, tolerance), inverse_(equations.point(), *equations.system().structure()) {
  f_.resize(equations.system().size());
}

void NewmarkFixedPointSteps::forget() {
  NewmarkSteps::forget();
  inverse_.forget();
  has_matrix_ = false;
}

bool NewmarkFixedPointSteps::solve(double time, double length, Vec u, Vec rate) {
  core::get(u, start_);
  core::get(rate, start_rate_);
  const double to = time + length, root_n = std::sqrt(static_cast<double>(start_.size()));
  value_ = start_ + length * start_rate_;
  double last = 0;
  for (int k = 0; k < most_fixed_point; ++k) {
    slope_ = sigma(length) * (value_ - start_) - kept() * start_rate_;
    // The matrix is that of a step of this length, at a place of the journals of some time ago.
    const bool renew = !has_matrix_ || !inverse_.fits(1 / sigma(length), operator_.parameter);
    equations().residual(to, value_, slope_, f_, renew ? &operator_.at : nullptr);
    if (renew) {
      operator_.alpha = 1;
      operator_.sigma = sigma(length);
      operator_.parameter = equations().system().parameter();
      operator_.at.films.d_inputs.setZero();
      for (core::PartResponse& own : operator_.at.films.own) own.inputs.setZero();
      inverse_.factorise_at(operator_);
      has_matrix_ = true;
    }
    operator_.sigma = sigma(length);
    inverse_.apply(operator_, f_, change_);
    value_ -= change_;
    const double moved = change_.norm() / root_n;
    if (!std::isfinite(moved) || (k > 3 && moved > last)) return false;
    last = moved;
    if (moved > tolerance()) continue;
    slope_ = sigma(length) * (value_ - start_) - kept() * start_rate_;
    core::put(value_, end());
    core::put(slope_, end_rate());
    return true;
  }
  return false;
}

}  // namespace whirl::transient
