#include "solve/shooting/sparse_step.hpp"

#include <cmath>
#include <cstdlib>

#include "solve/newton/local_part.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/index.hpp"

namespace whirl::solve {

using core::at;
using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd StepProduct::change(const MatrixXd& v, const Columns& lift, const Columns& load) const {
  std::vector<MatrixXd> k;
  MatrixXd out = MatrixXd::Zero(v.rows(), v.cols());
  for (Index j = 0; j < tableau_->stages(); ++j) {
    MatrixXd w = v;
    for (Index l = 0; l < j; ++l)
      if (tableau_->a(j, l) != 0) w += length_ * tableau_->a(j, l) * k[at(l)];
    if (!lift.empty()) w.col(0) += lift[at(j)];
    k.push_back(stages_[at(j)].slope(w, load.empty() ? nullptr : &load[at(j)]));
    if (tableau_->b(j) != 0) out += length_ * tableau_->b(j) * k.back();
  }
  return out;
}

void StepProduct::apply(MatrixXd& v) const {
  if (rate_) return apply_structured(v);
  v += change(v, {}, {});
}

SparseRungeKutta::SparseRungeKutta(problem::System& system, Tableau tableau, bool constant_rates, bool by_length)
    : system_(system),
      tableau_(std::move(tableau)),
      constant_rates_(constant_rates),
      by_length_wanted_(by_length),
      point_(system) {
  core::require(tableau_.sequential(), "steps distributed in space need a scheme with sequential stages");
  for (core::Vector* v : {&value_, &base_, &f_, &d_, &lift_}) *v = core::duplicate(point_.state_scale());
  for (Index j = 0; j < tableau_.stages(); ++j) slopes_.push_back(core::duplicate(point_.state_scale()));
  parts_ = PortStages::make(system);
  if (constant_rates) structured_ = StructuredRate::make(system);
  if (structured_ && !tableau_.is_explicit() && !structured_->narrow()) structured_.reset();
}

void SparseRungeKutta::fail() const {
  core::agree(system_.comm(), [] { throw core::DomainError("a stage of the Runge-Kutta step was not solved"); });
  std::abort();
}

// Making a matrix costs more than filling a small one: where only its product with the inverse is kept, one serves all.
StageProduct SparseRungeKutta::product_at(double angle, Vec x, Vec k, double own,
                                          std::shared_ptr<const StageSolver> solver) {
  if (solver->blocks() && own != 0) {
    std::shared_ptr<const PortMatrix> rates = rate_blocks_;
    if (!rates) {
      point_.jacobian(angle, x, k, 0, 1, scratch_);
      rates = parts_->blocks(scratch_.get());
      if (constant_rates_) rate_blocks_ = rates;
    }
    return {std::move(solver), std::move(rates), own, x};
  }
  if (solver->entrywise() && core::size_of(system_.comm()) == 1) {
    point_.jacobian(angle, x, k, 1, 0, scratch_);
    return {scratch_.get(), std::move(solver)};
  }
  core::Matrix jx;
  point_.jacobian(angle, x, k, 1, 0, jx);
  return {std::move(jx), std::move(solver), x};
}

std::shared_ptr<const StageSolver> SparseRungeKutta::solver_at(double angle, Vec x, Vec k, double own) {
  const bool kept = own == 0 && constant_rates_;
  if (kept && rates_) return rates_;
  std::shared_ptr<const StageSolver> solver;
  if (own != 0 && parts_) {
    point_.jacobian(angle, x, k, own, 1, scratch_);
    return parts_->solver(scratch_.get(), angle, point_.x(), point_.xdot(), own);
  }
  core::Matrix matrix;
  point_.jacobian(angle, x, k, own, 1, matrix);
  if (parts_ && !StageSolver::entrywise(matrix.get()))
    solver = parts_->solver(matrix.get(), angle, point_.x(), point_.xdot(), own);
  else
    solver = std::make_shared<const StageSolver>(std::move(matrix));
  if (kept) rates_ = solver;
  return solver;
}

// By chords: a matrix stays while every correction is at most a fifth of the last one.
std::shared_ptr<const StageSolver> SparseRungeKutta::solve_stage(double angle, double own, Vec base, Vec k) {
  const double tolerance = own == 0 ? 1e-13 : 1e-5;
  double size = 0, correction = 0, last = 0;
  check(VecNorm(base, NORM_INFINITY, &size));
  std::shared_ptr<const StageSolver> solver;
  for (int it = 0;; ++it) {
    check(VecWAXPY(value_.get(), own, k, base));
    point_.residual(angle, value_.get(), k, f_.get());
    if (!solver || (it > 1 && correction > 0.2 * last)) solver = solver_at(angle, value_.get(), k, own);
    solver->solve(f_.get(), d_.get(), tolerance);
    check(VecAXPY(k, -1, d_.get()));
    last = correction;
    check(VecNorm(d_.get(), NORM_INFINITY, &correction));
    if (!std::isfinite(correction)) fail();
    // F is linear in dx/dt, so that an explicit stage is solved at once.
    const double enough = parts_ && parts_->by_inverses() ? 1e-9 : 1e-11;
    if (own == 0 || own * correction <= enough * (1 + size)) return solver;
    if (it == 20) fail();
  }
}

void SparseRungeKutta::rate(double angle, Vec x, Vec xdot) {
  check(VecSet(xdot, 0));
  (void)solve_stage(angle, 0, x, xdot);
  // With the rates of damped liners known, the pressures that they turn on and off.
  if (!constant_rates_) (void)solve_stage(angle, 0, x, xdot);
}

void SparseRungeKutta::step(double angle, double d_angle, double length, Vec x, StepProduct* product) {
  if (structured_) {
    const core::WriteArray xa(x);
    return structured_step(angle, d_angle, length, {xa.data(), xa.size()}, product ? *product : unused_);
  }
  const Index s = tableau_.stages();
  StepProduct::Columns lifts, loads;
  if (parts_) parts_->begin_step();
  if (product) {
    product->tableau_ = &tableau_;
    product->length_ = length;
    product->stages_.clear();
  }
  for (Index j = 0; j < s; ++j) {
    const double own = length * tableau_.a(j, j), here = angle + tableau_.c(j) * d_angle;
    Vec k = slopes_[at(j)].get();
    check(VecSet(lift_.get(), 0));
    for (Index l = 0; l < j; ++l)
      if (tableau_.a(j, l) != 0) check(VecAXPY(lift_.get(), tableau_.a(j, l), slopes_[at(l)].get()));
    check(VecWAXPY(base_.get(), length, lift_.get(), x));
    if (j > 0)
      check(VecCopy(slopes_[at(j - 1)].get(), k));
    else
      check(VecSet(k, 0));
    auto solver = solve_stage(here, own, base_.get(), k);
    if (!product) continue;
    check(VecWAXPY(value_.get(), own, k, base_.get()));
    if (own != 0) solver = solver_at(here, value_.get(), k, own);
    product->stages_.push_back(product_at(here, value_.get(), k, own, std::move(solver)));
    check(VecAXPY(lift_.get(), tableau_.a(j, j), k));
    lifts.push_back(get(lift_.get()));
    point_.parameter_derivative(here, value_.get(), k, f_.get());
    loads.push_back(get(f_.get()));
  }
  check(VecSet(lift_.get(), 0));
  for (Index j = 0; j < s; ++j)
    if (tableau_.b(j) != 0) check(VecAXPY(lift_.get(), tableau_.b(j), slopes_[at(j)].get()));
  if (product) {
    const VectorXd mean = get(lift_.get());
    const MatrixXd zero = MatrixXd::Zero(mean.size(), 1);
    product->d_length_ = mean + product->change(zero, lifts, {}).col(0);
    product->d_parameter_ = product->change(zero, {}, loads).col(0);
  }
  check(VecAXPY(x, length, lift_.get()));
}

}  // namespace whirl::solve
