// Steps of systems that tell their structure.

#include <cmath>

#include "solve/shooting/sparse_step.hpp"
#include "whirl/core/index.hpp"

namespace whirl::solve {

using core::at;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// out += length sum over the first `count` of weights_l k_l.
template <class Weights, class Vector>
void add(double length, const Weights& weights, Index count, const MatrixXd& k, Vector& out) {
  for (Index l = 0; l < count; ++l)
    if (weights(l) != 0) out += length * weights(l) * k.col(l);
}

}  // namespace

// slope_now_ = k of k = f(base + own k) by Newton's method from slope_now_, with the derivatives of its last iteration.
void SparseRungeKutta::structured_stage(double angle, double own, RateMatrix& matrix, StructuredStage& solver) {
  const double enough = 1e-9 * (1 + base_now_.lpNorm<Eigen::Infinity>());
  VectorXd k = slope_now_;
  for (int it = 0;; ++it) {
    value_now_ = base_now_ + own * k;
    structured_->evaluate(angle, value_now_, slope_now_, matrix, d_parameter_now_);
    solver.factorise(*structured_, matrix, own);
    slope_now_ -= k;
    solver.solve(slope_now_.data());
    k += slope_now_;
    const double correction = slope_now_.lpNorm<Eigen::Infinity>();
    if (!std::isfinite(correction) || it == 20) fail();
    if (own * correction <= enough) break;
  }
  slope_now_ = k;
}

// The stages k_j = f(x + H sum a_jl k_l), and with S_j = (I - H a_jj A_j)^-1 the derivatives by H and by the parameter
//     d k_j = S_j A_j (sum_(l<=j) a_jl k_l + H sum_(l<j) a_jl d k_l),    S_j (A_j H sum_(l<j) a_jl d k_l + df/dp).
void SparseRungeKutta::structured_step(double angle, double d_angle, double length, Map<VectorXd> x,
                                       StepProduct& product) {
  const Index s = tableau_.stages(), n = x.size();
  const bool implicit = !tableau_.is_explicit();
  product.tableau_ = &tableau_;
  product.length_ = length;
  product.rate_ = structured_.get();
  product.rates_.resize(at(s));
  product.implicit_.resize(implicit ? at(s) : 0);
  stage_slopes_.resize(n, s);
  by_length_.setZero(n, by_length_wanted_ ? s : 0);
  by_parameter_.resize(n, s);
  for (Index j = 0; j < s; ++j) {
    const auto row = tableau_.a.row(j);
    const double here = angle + tableau_.c(j) * d_angle, own = length * tableau_.a(j, j);
    RateMatrix& matrix = product.rates_[at(j)];
    const auto solve = [&](double* r) {
      if (own != 0) product.implicit_[at(j)].solve(r);
    };
    base_now_ = x;
    add(length, row, j, stage_slopes_, base_now_);
    if (own != 0) {
      slope_now_ = j > 0 ? VectorXd(stage_slopes_.col(j - 1)) : VectorXd::Zero(n);
      structured_stage(here, own, matrix, product.implicit_[at(j)]);
    } else {
      structured_->evaluate(here, base_now_, slope_now_, matrix, d_parameter_now_);
    }
    if (!slope_now_.allFinite()) fail();
    stage_slopes_.col(j) = slope_now_;
    by_parameter_.col(j) = d_parameter_now_;
    if (j > 0) {
      value_now_.setZero(n);
      add(length, row, j, by_parameter_, value_now_);
      structured_->times(matrix, value_now_.data(), slope_now_.data());
      by_parameter_.col(j) += slope_now_;
    }
    solve(by_parameter_.col(j).data());
    if (!by_length_wanted_) continue;
    value_now_.setZero(n);
    add(1, row, j + 1, stage_slopes_, value_now_);
    add(length, row, j, by_length_, value_now_);
    structured_->times(matrix, value_now_.data(), by_length_.col(j).data());
    solve(by_length_.col(j).data());
  }
  value_now_ = x;
  add(length, tableau_.b, s, stage_slopes_, value_now_);
  x = value_now_;
  product.d_parameter_.setZero(n);
  add(length, tableau_.b, s, by_parameter_, product.d_parameter_);
  if (!by_length_wanted_) return;
  product.d_length_.setZero(n);
  add(1, tableau_.b, s, stage_slopes_, product.d_length_);
  add(length, tableau_.b, s, by_length_, product.d_length_);
}

void StepProduct::apply_structured(MatrixXd& v) const {
  const Index s = tableau_->stages();
  MatrixXd& work = rate_->work();
  work.resize(v.rows(), s + 1);
  auto w = work.col(s);
  for (Index c = 0; c < v.cols(); ++c) {
    auto x = v.col(c);
    for (Index j = 0; j < s; ++j) {
      w = x;
      add(length_, tableau_->a.row(j), j, work, w);
      rate_->times(rates_[at(j)], w.data(), work.col(j).data());
      if (tableau_->a(j, j) != 0) implicit_[at(j)].solve(work.col(j).data());
    }
    add(length_, tableau_->b, s, work, x);
  }
}

}  // namespace whirl::solve
