// Explicit steps of systems that tell their structure.

#include "solve/sparse_step.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

// out += length sum over the first `count` of weights_l k_l.
template <class Weights, class Vector>
void add(double length, const Weights& weights, Index count, const MatrixXd& k, Vector& out) {
  for (Index l = 0; l < count; ++l)
    if (weights(l) != 0) out += length * weights(l) * k.col(l);
}

}  // namespace

// The stages k_j = f(x + H sum a_jl k_l), and for the derivatives by H and by the parameter
//     d k_j = A_j (sum_l a_jl (k_l + H d k_l)),    A_j H sum_l a_jl d k_l + df/dp.
void SparseRungeKutta::structured_step(double angle, double d_angle, double length, Map<VectorXd> x,
                                       StepProduct& product) {
  const Index s = tableau_.stages(), n = x.size();
  product.tableau_ = &tableau_;
  product.length_ = length;
  product.rate_ = structured_.get();
  product.rates_.resize(at(s));
  stage_slopes_.resize(n, s);
  by_length_.setZero(n, by_length_wanted_ ? s : 0);
  by_parameter_.resize(n, s);
  for (Index j = 0; j < s; ++j) {
    const auto row = tableau_.a.row(j);
    RateMatrix& matrix = product.rates_[at(j)];
    value_now_ = x;
    add(length, row, j, stage_slopes_, value_now_);
    structured_->evaluate(angle + tableau_.c(j) * d_angle, value_now_, slope_now_, matrix, d_parameter_now_);
    if (!slope_now_.allFinite()) fail();
    stage_slopes_.col(j) = slope_now_;
    by_parameter_.col(j) = d_parameter_now_;
    if (j == 0) continue;  // nothing before it
    value_now_.setZero();
    add(length, row, j, by_parameter_, value_now_);
    structured_->times(matrix, value_now_.data(), slope_now_.data());
    by_parameter_.col(j) += slope_now_;
    if (!by_length_wanted_) continue;
    value_now_.setZero();
    add(1, row, j, stage_slopes_, value_now_);
    add(length, row, j, by_length_, value_now_);
    structured_->times(matrix, value_now_.data(), by_length_.col(j).data());
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
    }
    add(length_, tableau_->b, s, work, x);
  }
}

}  // namespace whirl::solve
