#include "transient/steps/newmark.hpp"

#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/core/local_part.hpp"

namespace whirl::transient {

using Eigen::VectorXd;

namespace {

constexpr int most_newton = 12, most_fixed_point = 100;
// Of a step, in which rates are found: its error is that part of what trapezoids lose, and rounding is far below.
constexpr double rate_part = 1e-6;

}  // namespace

NewmarkSteps::NewmarkSteps(Equations& equations, bool linearised, bool regular, double tolerance)
    : equations_(equations),
      tolerance_(tolerance),
      linearised_(linearised),
      stage_(equations.make_stage()),
      regular_(regular) {}

void NewmarkSteps::forget() {
  pass_break();
  stage_ = equations_.make_stage();
}

void NewmarkSteps::set_rate(double length, const VectorXd& u, const VectorXd& rate) {
  end_rate_ = (end_ - u) / own(length) - kept() * rate;
}

bool NewmarkSteps::solve(double time, double length, const VectorXd& u, const VectorXd& rate) {
  if (!linearised_) return newton(time, length, u, rate);
  // F + J du + E (2/h du - 2 r_0) = 0, the step of Euler with r_0 once; with A = E + own J, A^-1 E r_0 = r_0 + own dk.
  equations_.residual(*stage_, time + length, u, rate, f_, true);
  equations_.keep(*stage_, time + length, own(length), u, rate);
  Eigen::MatrixXd dk(u.size(), 1);
  stage_->solve(f_, equations_.tolerance());
  stage_->slopes(rate, false, dk);
  end_ = u - own(length) * (f_ - (1 + kept()) * (rate + own(length) * dk));
  set_rate(length, u, rate);
  return std::isfinite(equations_.root_mean(end_.squaredNorm()));
}

bool NewmarkSteps::newton(double time, double length, const VectorXd& u, const VectorXd& rate) {
  end_ = u + length * rate;
  double last = 0;
  for (int k = 0; k < most_newton; ++k) {
    set_rate(length, u, rate);
    equations_.residual(*stage_, time + length, end_, end_rate_, f_, true);
    equations_.factorise(*stage_, own(length), end_, end_rate_);
    stage_->solve(f_, equations_.tolerance());
    end_ -= own(length) * f_;
    const double moved = own(length) * equations_.root_mean(f_.squaredNorm());
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
void NewmarkSteps::begin(double time, double wanted) {
  if (regular_) {
    try {
      return equations_.rate(time, start_, rate_);
    } catch (const core::NotConverged&) {
      regular_ = false;  // no row is zero, but some depend on each other
    }
  }
  euler_ = true;
  rate_.setZero(start_.size());
  const double e = rate_part * wanted;
  try {
    if (!newton(time, e, start_, rate_)) return;
    const VectorXd consistent = end_;
    if (!newton(time + e, e, consistent, rate_)) return;
  } catch (const core::DomainError&) {
    return;
  }
  rate_ = end_rate_;
  euler_ = false;
}

Taken NewmarkSteps::step(double time, double wanted, Vec u) {
  core::get(u, start_);
  euler_ = false;
  if (!has_rate_) begin(time, wanted);
  has_rate_ = true;
  const Taken taken = take_step(wanted, 1, [&](double h) -> std::optional<double> {
    return solve(time, h, start_, rate_) ? std::optional(0.0) : std::nullopt;
  });
  core::put(end_, u);
  rate_ = end_rate_;
  return {taken.length, taken.length, taken.rejected, taken.why};
}

NewmarkFixedPointSteps::NewmarkFixedPointSteps(Equations& equations, bool regular, double tolerance)
    : NewmarkSteps(equations, false, regular, tolerance), lagging_(equations.make_stage()) {}

void NewmarkFixedPointSteps::forget() {
  NewmarkSteps::forget();
  lagging_ = equations_.make_stage();
}

void NewmarkFixedPointSteps::pass_break() {
  NewmarkSteps::pass_break();
  has_matrix_ = false;
}

bool NewmarkFixedPointSteps::solve(double time, double length, const VectorXd& u, const VectorXd& rate) {
  end_ = u + length * rate;
  double last = 0;
  for (int k = 0; k < most_fixed_point; ++k) {
    set_rate(length, u, rate);
    // The matrix is that of a step of this length, at a place of the journals of some time ago.
    const solve::StepOf here{own(length), equations_.system().parameter()};
    const bool renew = !has_matrix_ || !made_.is_near(here);
    equations_.residual(*lagging_, time + length, end_, end_rate_, f_, renew);
    if (renew) {
      equations_.factorise(*lagging_, here.own, end_, end_rate_, true);
      made_ = here;
      has_matrix_ = true;
    }
    lagging_->solve(f_, 1);
    end_ -= here.own * f_;
    const double moved = here.own * equations_.root_mean(f_.squaredNorm());
    if (!std::isfinite(moved) || (k > 3 && moved > last)) return false;
    last = moved;
    if (moved > tolerance_) continue;
    set_rate(length, u, rate);
    return true;
  }
  return false;
}

}  // namespace whirl::transient
