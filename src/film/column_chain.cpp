#include "film/column_chain.hpp"

#include <Eigen/LU>
#include <algorithm>

namespace whirl::film {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

namespace {

// Gauss-Jordan by blocks of rows, without exchanging them.
void invert(MatrixXd& a) {
  constexpr Index block = 16;
  const Index n = a.rows();
  MatrixXd rows, columns;
  for (Index k = 0; k < n; k += block) {
    const Index b = std::min(block, n - k);
    const MatrixXd pivot = a.block(k, k, b, b).inverse();
    rows.noalias() = pivot * a.middleRows(k, b);
    rows.middleCols(k, b) = pivot;
    columns = a.middleCols(k, b);
    columns.middleRows(k, b).setZero();
    a.middleCols(k, b).setZero();
    a.noalias() -= columns * rows;
    a.middleRows(k, b) = rows;
  }
}

}  // namespace

void ColumnChain::factor(const Strip& strip) {
  before_ = strip.before;
  after_ = strip.after;
  inverses_.resize(static_cast<std::size_t>(strip.itself.cols()));
  for (Index k = 0; k < strip.itself.cols(); ++k) factor(strip, k);
}

void ColumnChain::factor(const Strip& strip, Index k) {
  const Index n = strip.itself.rows();
  Inverse& v = inverses_[static_cast<std::size_t>(k)];
  const Inverse* last = k > 0 ? &inverses_[static_cast<std::size_t>(k - 1)] : nullptr;
  const ArrayXd l = strip.before.col(k), u = k > 0 ? ArrayXd(after_.col(k - 1)) : ArrayXd(ArrayXd::Zero(n));
  std::vector<Index> place(static_cast<std::size_t>(n), -1);  // among the dense columns of the last V
  if (last && (l != 0.0).any())
    for (std::size_t p = 0; p < last->dense.size(); ++p)
      place[static_cast<std::size_t>(last->dense[p])] = static_cast<Index>(p);

  v.dense.clear();
  v.diagonal = strip.itself.col(k);
  if (last) v.diagonal.array() -= l * last->diagonal.array() * u;
  for (Index j = 0; j < n; ++j) {
    const bool spreads = (j > 0 && strip.above(j - 1, k) != 0.0) || (j + 1 < n && strip.below(j + 1, k) != 0.0) ||
                         (place[static_cast<std::size_t>(j)] >= 0 && u(j) != 0.0);
    if (spreads) v.dense.push_back(static_cast<int>(j));
  }
  const auto n_dense = static_cast<Index>(v.dense.size());
  MatrixXd s = MatrixXd::Zero(n, n_dense), own(n_dense, n_dense);
  for (Index p = 0; p < n_dense; ++p) {
    const Index j = v.dense[static_cast<std::size_t>(p)], from = place[static_cast<std::size_t>(j)];
    if (from >= 0 && u(j) != 0.0) s.col(p) = -u(j) * l * last->values.col(from).array();
    s(j, p) += v.diagonal(j);
    if (j > 0) s(j - 1, p) += strip.above(j - 1, k);
    if (j + 1 < n) s(j + 1, p) += strip.below(j + 1, k);
  }
  v.diagonal = v.diagonal.cwiseInverse();
  for (Index p = 0; p < n_dense; ++p) {
    v.diagonal(v.dense[static_cast<std::size_t>(p)]) = 0.0;
    own.row(p) = s.row(v.dense[static_cast<std::size_t>(p)]);
  }
  invert(own);
  if (n_dense == n) {
    v.values = std::move(own);
    return;
  }
  v.values.noalias() = -(v.diagonal.asDiagonal() * s) * own;
  for (Index p = 0; p < n_dense; ++p) v.values.row(v.dense[static_cast<std::size_t>(p)]) = own.row(p);
}

MatrixXd ColumnChain::last() const {
  const Inverse& v = inverses_.back();
  MatrixXd out = v.diagonal.asDiagonal();
  for (std::size_t p = 0; p < v.dense.size(); ++p) out.col(v.dense[p]) = v.values.col(static_cast<Index>(p));
  return out;
}

MatrixXd ColumnChain::times(bool transposed, const Inverse& v, const MatrixXd& b) {
  const bool all = static_cast<Index>(v.dense.size()) == b.rows();
  if (all && !transposed) return v.values * b;
  MatrixXd out = v.diagonal.asDiagonal() * b;
  if (v.dense.empty()) return out;
  if (!transposed)
    out.noalias() += v.values * b(v.dense, Eigen::all);
  else
    out(v.dense, Eigen::all) += v.values.transpose() * b;
  return out;
}

void ColumnChain::forward(bool transposed, Ref<MatrixXd> r) const {
  const Index n = before_.rows();
  MatrixXd b;
  for (Index k = 0; k < columns(); ++k) {
    b = r.middleRows(k * n, n);
    if (k > 0)
      b.array() -= r.middleRows((k - 1) * n, n).array().colwise() * (transposed ? after_.col(k - 1) : before_.col(k));
    r.middleRows(k * n, n) = times(transposed, inverses_[static_cast<std::size_t>(k)], b);
  }
}

void ColumnChain::backward(bool transposed, Ref<MatrixXd> z, const VectorXd* beyond) const {
  const Index n = before_.rows();
  MatrixXd b;
  for (Index k = columns() - 1; k >= 0; --k) {
    if (k + 1 < columns())
      b = (z.middleRows((k + 1) * n, n).array().colwise() * (transposed ? before_.col(k + 1) : after_.col(k))).matrix();
    else if (beyond)
      b = *beyond;
    else
      continue;
    z.middleRows(k * n, n) -= times(transposed, inverses_[static_cast<std::size_t>(k)], b);
  }
}

}  // namespace whirl::film
