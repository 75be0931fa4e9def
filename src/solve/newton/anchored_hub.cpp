#include "solve/newton/anchored_hub.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace whirl::solve {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

bool AnchoredHub::serves() {
  const problem::SparseBlock& l0 = blocks_->l0;
  if (!made_ || l0.rows() != l0_.rows() || l0.nonZeros() != l0_.nonZeros()) return false;
  if (!std::equal(l0.outerIndexPtr(), l0.outerIndexPtr() + l0.cols() + 1, l0_.outerIndexPtr())) return false;
  if (!std::equal(l0.innerIndexPtr(), l0.innerIndexPtr() + l0.nonZeros(), l0_.innerIndexPtr())) return false;
  std::vector<bool> of_rate(static_cast<std::size_t>(l0.cols()), false);
  for (const problem::KinematicRow& k : blocks_->kinematic) of_rate[static_cast<std::size_t>(k.rate)] = true;
  exact_ = true;
  for (Index c = 0; c < l0.cols(); ++c) {
    const int begin = l0.outerIndexPtr()[c], end = l0.outerIndexPtr()[c + 1];
    if (std::equal(l0.valuePtr() + begin, l0.valuePtr() + end, l0_.valuePtr() + begin)) continue;
    exact_ = false;
    if (!of_rate[static_cast<std::size_t>(c)]) return false;
  }
  return true;
}

bool AnchoredHub::factorise(const MatrixXd& anchor) {
  anchor_ = anchor;
  l0_ = blocks_->l0;
  const problem::SparseBlock forces = MatrixXd(anchor_ * blocks_->c).sparseView(), ports = blocks_->b * forces;
  made_ = exact_ = lu_.factorise(l0_ - ports, blocks_->b, blocks_->c) && lu_.seen().allFinite();
  return made_;
}

bool AnchoredHub::set(const problem::ThinBlocks& blocks, const MatrixXd& tangents, VectorXd column, VectorXd row) {
  // Beyond that the update would take too many digits of the answer: films that have come under load since.
  constexpr double most = 1e3;
  blocks_ = &blocks;
  const Index r = blocks.b.cols(), n = blocks.l0.rows();
  const bool anchored = anchor_.rows() == r && anchor_.cols() == tangents.cols();
  if (!serves() && !(anchored && factorise(anchor_)) && !factorise(tangents)) return false;
  const auto change = [&] {
    moved_ = tangents - anchor_;
    return MatrixXd(moved_ * lu_.seen());
  };
  MatrixXd through = change();
  if (through.size() > 0 && through.cwiseAbs().maxCoeff() > most) {
    if (!factorise(tangents)) return false;
    through = change();
  }
  tangents_ = tangents;
  column_ = std::move(column);
  row_ = std::move(row);
  by_column_.resize(n);
  lu_.solve(column_, by_column_);
  MatrixXd small(r + 1, r + 1);
  small.topLeftCorner(r, r) = MatrixXd::Identity(r, r) - through;
  small.topRightCorner(r, 1) = moved_ * (blocks.c * by_column_);
  small.bottomLeftCorner(1, r) = row_.head(n).transpose() * lu_.lead();
  small(r, r) = row_(n) - row_.head(n).dot(by_column_);
  small_.compute(small);
  return true;
}

VectorXd AnchoredHub::multiply(const VectorXd& x) const {
  const Index n = column_.size();
  VectorXd y(n + 1);
  y.head(n) = blocks_->l0 * x.head(n);
  y.head(n) -= blocks_->b * (tangents_ * (blocks_->c * x.head(n)));
  y.head(n) += x(n) * column_;
  y(n) = row_.dot(x);
  return y;
}

VectorXd AnchoredHub::multiply_transposed(const VectorXd& y) const {
  const Index n = column_.size();
  VectorXd x = y(n) * row_;
  x.head(n) += blocks_->l0.transpose() * y.head(n);
  x.head(n) -= blocks_->c.transpose() * (tangents_.transpose() * (blocks_->b.transpose() * y.head(n)));
  x(n) += column_.dot(y.head(n));
  return x;
}

VectorXd AnchoredHub::apply(const VectorXd& y) const {
  const Index n = column_.size(), r = moved_.rows();
  VectorXd x(n + 1), right(r + 1);
  lu_.solve(y.head(n), x.head(n));
  right.head(r) = moved_ * (blocks_->c * x.head(n));
  right(r) = y(n) - row_.head(n).dot(x.head(n));
  const VectorXd answer = small_.solve(right);
  x.head(n) += lu_.lead() * answer.head(r) - answer(r) * by_column_;
  x(n) = answer(r);
  return x;
}

// With g = B^T x: x = M^-T (y + C^T (D - D0)^T g - row p), and g and p by the transpose of the same small matrix.
VectorXd AnchoredHub::apply_transposed(const VectorXd& y) const {
  const Index n = column_.size(), r = moved_.rows();
  VectorXd x(n + 1), right(r + 1);
  right.head(r) = lu_.lead().transpose() * y.head(n);
  right(r) = y(n) - by_column_.dot(y.head(n));
  const VectorXd answer = small_.solve_transposed(right);
  const VectorXd load =
      y.head(n) + blocks_->c.transpose() * (moved_.transpose() * answer.head(r)) - answer(r) * row_.head(n);
  lu_.solve_transposed(load, x.head(n));
  x(n) = answer(r);
  return x;
}

VectorXd AnchoredHub::solve(const VectorXd& y) const {
  const VectorXd x = apply(y);
  return exact_ ? x : x + apply(y - multiply(x));
}

VectorXd AnchoredHub::solve_transposed(const VectorXd& y) const {
  const VectorXd x = apply_transposed(y);
  return exact_ ? x : x + apply_transposed(y - multiply_transposed(x));
}

}  // namespace whirl::solve
