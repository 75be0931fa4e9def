#include "whirl/solve/shooting/runge_kutta.hpp"

#include <cmath>

#include "whirl/core/agree.hpp"
#include "whirl/core/index.hpp"

namespace whirl::solve {

using core::at;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr int most_corrections = 20;
constexpr double slow_chord = 0.2;  // pays for a new one

}  // namespace

std::unique_ptr<Stages> choose_stages(problem::System& system, const Tableau& tableau, bool constant_rates,
                                      problem::ScaledPoint* point) {
  if (constant_rates)
    if (auto structured = structured_stages(system, tableau)) return structured;
  return point ? dense_stages(*point) : sparse_stages(system, constant_rates);
}

// In all stages dF/dx (v + lift_j + H sum_l a(j,l) dk_l) + dF/d(dx/dt) dk_j (+ dF/dp) = 0, the lifts in the first
// column and dF/dp in the last.
void StepDerivative::change(MatrixXd& v, const MatrixXd* lifts, bool loaded) const {
  const Tableau& t = scheme_->tableau_;
  const Index n = v.rows(), m = scheme_->together_;
  MatrixXd& dk = scheme_->dk_;
  carry_stages(t, m, length_, v, scheme_->w_, dk, [&](Index first, MatrixXd& w, auto of_group) {
    for (Index j = 0; lifts && j < m; ++j) w.col(0).segment(j * n, n) += lifts->col(first + j);
    stages_[at(first / m)]->slopes(w, loaded, of_group);
  });
  for (Index j = 0; j < t.stages(); ++j)
    if (t.b(j) != 0) v += length_ * t.b(j) * dk.middleRows(j * n, n);
}

void StepDerivative::carry(MatrixXd& v) const {
  change(v, nullptr, false);
}

RungeKutta::RungeKutta(std::unique_ptr<Stages> stages, Tableau tableau, bool by_length)
    : stages_(std::move(stages)),
      tableau_(std::move(tableau)),
      together_(tableau_.sequential() ? 1 : tableau_.stages()),
      by_length_(by_length),
      shared_(core::size_of(stages_->comm()) > 1) {}

double RungeKutta::largest(const MatrixXd& v) const {
  double size = v.size() > 0 ? v.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() : 0;
  if (std::isnan(size)) size = INFINITY;  // which the maximum over ranks keeps
  if (shared_) MPI_Allreduce(MPI_IN_PLACE, &size, 1, MPI_DOUBLE, MPI_MAX, stages_->comm());
  return size;
}

void RungeKutta::place() {
  x_ = base_;
  for (Index j = 0; j < x_.cols(); ++j)
    for (Index l = 0; l < x_.cols(); ++l)
      if (group_.own(j, l) != 0) x_.col(j) += group_.own(j, l) * k_.col(l);
}

void RungeKutta::find(Stage& stage) {
  const bool implicit = !group_.is_explicit();
  const double size = implicit ? largest(base_) : 0, own = group_.own.lpNorm<Eigen::Infinity>();
  double correction = 0, last = 0;
  for (int it = 0;; ++it) {
    place();
    const bool renew = it == 0 || !stages_->by_chords() || (it > 1 && correction > slow_chord * last);
    f_.resize(x_.rows(), x_.cols());
    stage.residual(group_, x_, k_, f_, renew);
    if (renew) stage.factorise(group_, x_, k_);
    stage.solve(f_, 1);
    k_ -= f_;
    last = correction;
    correction = largest(f_);
    // F is linear in dx/dt, so that an explicit stage is solved at once.
    const bool arrived = !implicit || own * correction <= stages_->tolerance() * (1 + size);
    if (std::isfinite(correction) && arrived) return;
    if (it < most_corrections && std::isfinite(correction)) continue;
    const auto fail = [] { throw core::DomainError("a stage of the Runge-Kutta step was not solved"); };
    if (shared_) core::agree(stages_->comm(), fail);
    fail();
  }
}

void RungeKutta::step(double angle, double d_angle, double length, VectorXd& x, StepDerivative* derivative) {
  const Index n = x.size(), s = tableau_.stages(), m = together_;
  StepDerivative& to = derivative ? *derivative : unused_;
  to.scheme_ = this;
  to.length_ = length;
  while (to.stages_.size() < at(s / m)) to.stages_.push_back(stages_->make());
  stages_->begin_step();
  slopes_.setZero(n, s);
  for (Index first = 0; first < s; first += m) {
    Stage& stage = *to.stages_[at(first / m)];
    group_.angle = angle + d_angle * tableau_.c.segment(first, m).array();
    group_.own = length * tableau_.a.block(first, first, m, m);
    base_ = x.replicate(1, m);
    for (Index l = 0; l < first; ++l)
      if (tableau_.a(first, l) != 0) base_ += length * tableau_.a(first, l) * slopes_.col(l);
    k_ = slopes_.middleCols(first > 0 ? first - 1 : 0, m);
    find(stage);
    slopes_.middleCols(first, m) = k_;
    if (!derivative) continue;
    place();
    stage.keep(group_, x_, k_);
  }
  if (derivative) {
    // d x_j/dH = sum_l a(j,l) (k_l + H dk_l)
    if (by_length_) lifts_.noalias() = slopes_ * tableau_.a.transpose();
    changes_.setZero(n, by_length_ ? 2 : 1);
    to.change(changes_, by_length_ ? &lifts_ : nullptr, true);
    to.d_parameter_ = changes_.rightCols(1);
    if (by_length_) to.d_length_ = changes_.col(0) + slopes_ * tableau_.b;
  }
  for (Index j = 0; j < s; ++j)
    if (tableau_.b(j) != 0) x += length * tableau_.b(j) * slopes_.col(j);
}

VectorXd RungeKutta::rate(double angle, const VectorXd& x) {
  if (unused_.stages_.empty()) unused_.stages_.push_back(stages_->make());
  group_ = {VectorXd::Constant(1, angle), MatrixXd::Zero(1, 1)};
  base_ = x;
  k_.setZero(x.size(), 1);
  // With the rates of damped liners known, the pressures that they turn on and off.
  for (int pass = 0; pass < 2; ++pass) find(*unused_.stages_.front());
  return k_;
}

}  // namespace whirl::solve
