#include "film/algebra/column_chain.hpp"

#include <algorithm>

#include "whirl/core/dense_lu.hpp"

namespace whirl::film {

using Eigen::Index;
using Eigen::Ref;

namespace {

// Gauss-Jordan by blocks of rows, without exchanging them.
template <class Matrix>
void invert(Matrix& a) {
  constexpr Index block = 16;
  const Index n = a.rows();
  Matrix rows, columns;
  for (Index k = 0; k < n; k += block) {
    const Index b = std::min(block, n - k);
    const Matrix pivot = core::DenseLu<typename Matrix::Scalar>(a.block(k, k, b, b)).inverse();
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

template <class Scalar>
void ColumnChain<Scalar>::factor(const Strip<Scalar>& strip) {
  before_ = strip.before;
  after_ = strip.after;
  inverses_.resize(static_cast<std::size_t>(strip.itself.cols()));
  for (Index k = 0; k < strip.itself.cols(); ++k) factor(strip, k);
}

template <class Scalar>
void ColumnChain<Scalar>::factor(const Strip<Scalar>& strip, Index k) {
  using Array = Eigen::Array<Scalar, Eigen::Dynamic, 1>;
  const Scalar zero(0);
  const Index n = strip.itself.rows();
  Inverse& v = inverses_[static_cast<std::size_t>(k)];
  const Inverse* last = k > 0 ? &inverses_[static_cast<std::size_t>(k - 1)] : nullptr;
  const Array l = strip.before.col(k), u = k > 0 ? Array(after_.col(k - 1)) : Array(Array::Zero(n));
  std::vector<Index> place(static_cast<std::size_t>(n), -1);  // among the dense columns of the last V
  if (last && (l != zero).any())
    for (std::size_t p = 0; p < last->dense.size(); ++p)
      place[static_cast<std::size_t>(last->dense[p])] = static_cast<Index>(p);

  v.dense.clear();
  v.diagonal = strip.itself.col(k);
  if (last) v.diagonal.array() -= l * last->diagonal.array() * u;
  for (Index j = 0; j < n; ++j) {
    const bool spreads = (j > 0 && strip.above(j - 1, k) != zero) || (j + 1 < n && strip.below(j + 1, k) != zero) ||
                         (place[static_cast<std::size_t>(j)] >= 0 && u(j) != zero);
    if (spreads) v.dense.push_back(static_cast<int>(j));
  }
  const auto n_dense = static_cast<Index>(v.dense.size());
  Matrix s = Matrix::Zero(n, n_dense), own(n_dense, n_dense);
  for (Index p = 0; p < n_dense; ++p) {
    const Index j = v.dense[static_cast<std::size_t>(p)], from = place[static_cast<std::size_t>(j)];
    if (from >= 0 && u(j) != zero) s.col(p) = -u(j) * l * last->values.col(from).array();
    s(j, p) += v.diagonal(j);
    if (j > 0) s(j - 1, p) += strip.above(j - 1, k);
    if (j + 1 < n) s(j + 1, p) += strip.below(j + 1, k);
  }
  v.diagonal = v.diagonal.cwiseInverse();
  for (Index p = 0; p < n_dense; ++p) {
    v.diagonal(v.dense[static_cast<std::size_t>(p)]) = zero;
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

template <class Scalar>
typename ColumnChain<Scalar>::Matrix ColumnChain<Scalar>::last() const {
  const Inverse& v = inverses_.back();
  Matrix out = v.diagonal.asDiagonal();
  for (std::size_t p = 0; p < v.dense.size(); ++p) out.col(v.dense[p]) = v.values.col(static_cast<Index>(p));
  return out;
}

template <class Scalar>
typename ColumnChain<Scalar>::Matrix ColumnChain<Scalar>::times(bool transposed, const Inverse& v, const Matrix& b) {
  const bool all = static_cast<Index>(v.dense.size()) == b.rows();
  if (all && !transposed) return v.values * b;
  Matrix out = v.diagonal.asDiagonal() * b;
  const auto n_dense = static_cast<Index>(v.dense.size());
  if (n_dense == 0) return out;
  Matrix part(n_dense, b.cols());
  if (transposed) part.noalias() = v.values.transpose() * b;
  for (Index c = 0; c < b.cols(); ++c)
    for (Index p = 0; p < n_dense; ++p) {
      const int row = v.dense[static_cast<std::size_t>(p)];
      if (transposed)
        out(row, c) += part(p, c);
      else
        part(p, c) = b(row, c);
    }
  if (!transposed) out.noalias() += v.values * part;
  return out;
}

template <class Scalar>
void ColumnChain<Scalar>::forward(bool transposed, Ref<Matrix> r) const {
  const Index n = before_.rows();
  Matrix b;
  for (Index k = 0; k < columns(); ++k) {
    b = r.middleRows(k * n, n);
    if (k > 0)
      b.array() -= r.middleRows((k - 1) * n, n).array().colwise() * (transposed ? after_.col(k - 1) : before_.col(k));
    r.middleRows(k * n, n) = times(transposed, inverses_[static_cast<std::size_t>(k)], b);
  }
}

template <class Scalar>
void ColumnChain<Scalar>::backward(bool transposed, Ref<Matrix> z, const Matrix* beyond) const {
  const Index n = before_.rows();
  Matrix b;
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

template class ColumnChain<double>;
template class ColumnChain<std::complex<double>>;

}  // namespace whirl::film
