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
template <class Weights>
void add(double length, const Weights& weights, Index count, const MatrixXd& k, VectorXd& out) {
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
  MatrixXd k(n, s), by_length(n, s), by_parameter(n, s);
  VectorXd value, slope, d_parameter, seen(n);
  for (Index j = 0; j < s; ++j) {
    const auto row = tableau_.a.row(j);
    RateMatrix& matrix = product.rates_[at(j)];
    value = x;
    add(length, row, j, k, value);
    structured_->evaluate(angle + tableau_.c(j) * d_angle, value, slope, matrix, d_parameter);
    if (!slope.allFinite()) fail();
    k.col(j) = slope;
    value.setZero();
    add(1, row, j, k, value);
    add(length, row, j, by_length, value);
    structured_->times(matrix, value.data(), by_length.col(j).data());
    value.setZero();
    add(length, row, j, by_parameter, value);
    structured_->times(matrix, value.data(), by_parameter.col(j).data());
    by_parameter.col(j) += d_parameter;
  }
  value = x;
  add(length, tableau_.b, s, k, value);
  x = value;
  product.d_length_.setZero(n);
  add(1, tableau_.b, s, k, product.d_length_);
  add(length, tableau_.b, s, by_length, product.d_length_);
  product.d_parameter_.setZero(n);
  add(length, tableau_.b, s, by_parameter, product.d_parameter_);
}

void StepProduct::apply_structured(MatrixXd& v) const {
  const Index s = tableau_->stages();
  MatrixXd k(v.rows(), s);
  VectorXd w(v.rows());
  for (Index c = 0; c < v.cols(); ++c) {
    for (Index j = 0; j < s; ++j) {
      w = v.col(c);
      add(length_, tableau_->a.row(j), j, k, w);
      rate_->times(rates_[at(j)], w.data(), k.col(j).data());
    }
    w = v.col(c);
    add(length_, tableau_->b, s, k, w);
    v.col(c) = w;
  }
}

}  // namespace whirl::solve
