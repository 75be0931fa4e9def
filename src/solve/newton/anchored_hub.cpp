#include "solve/newton/anchored_hub.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace whirl::solve {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

bool same(const problem::SparseBlock& a, const problem::SparseBlock& b) {
  const auto equal = [](const auto* p, const auto* q, Index count) { return std::equal(p, p + count, q); };
  return a.rows() == b.rows() && a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         equal(a.outerIndexPtr(), b.outerIndexPtr(), a.cols() + 1) &&
         equal(a.innerIndexPtr(), b.innerIndexPtr(), a.nonZeros()) && equal(a.valuePtr(), b.valuePtr(), a.nonZeros());
}

}  // namespace

problem::SparseBlock AnchoredHub::without_rates() const {
  std::vector<int> row_of(static_cast<std::size_t>(blocks_->l0.cols()), -1);  // that says which state's rate it is
  for (const problem::KinematicRow& k : blocks_->kinematic) row_of[static_cast<std::size_t>(k.rate)] = k.row;
  problem::SparseBlock out = blocks_->l0;
  for (Index c = 0; c < out.cols(); ++c)
    if (const int own = row_of[static_cast<std::size_t>(c)]; own >= 0)
      for (problem::SparseBlock::InnerIterator it(out, c); it; ++it)
        if (it.row() != own) it.valueRef() = 0;
  return out;
}

bool AnchoredHub::factorise(const MatrixXd& anchor) {
  anchor_ = anchor;
  const problem::SparseBlock forces = MatrixXd(anchor_ * blocks_->c).sparseView(), ports = blocks_->b * forces;
  made_ = lu_.factorise(l0_ - ports, blocks_->b, blocks_->c) && lu_.seen().allFinite();
  return made_;
}

// At a fold M is singular or nearly so. Stiffer films move the place where it is.
bool AnchoredHub::anchor_at(const MatrixXd& tangents) {
  constexpr double nearly_singular = 1e6, stiffer = 1.1;
  const auto near_a_fold = [&] {
    return tangents.size() > 0 && (tangents * lu_.seen()).cwiseAbs().maxCoeff() > nearly_singular;
  };
  return (factorise(tangents) && !near_a_fold()) || factorise(stiffer * tangents);
}

bool AnchoredHub::set(const problem::ThinBlocks& blocks, const MatrixXd& tangents, VectorXd column, VectorXd row) {
  // Beyond that the update would take too many digits of the answer: films that have come under load since.
  constexpr double most = 1e3;
  blocks_ = &blocks;
  const Index r = blocks.b.cols(), n = blocks.l0.rows();
  const bool anchored = anchor_.rows() == r && anchor_.cols() == tangents.cols();
  problem::SparseBlock l0 = without_rates();
  if (!made_ || !same(l0, l0_) || !same(blocks.b, b_) || !same(blocks.c, c_)) {
    l0_ = std::move(l0);
    b_ = blocks.b;
    c_ = blocks.c;
    if (!(anchored && factorise(MatrixXd(anchor_))) && !anchor_at(tangents)) return false;
  }
  const auto change = [&] {
    moved_ = tangents - anchor_;
    return MatrixXd(moved_ * lu_.seen());
  };
  MatrixXd through = change();
  if (through.size() > 0 && through.cwiseAbs().maxCoeff() > most) {
    if (!anchor_at(tangents)) return false;
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
  return x + apply(y - multiply(x));
}

VectorXd AnchoredHub::solve_transposed(const VectorXd& y) const {
  const VectorXd x = apply_transposed(y);
  return x + apply_transposed(y - multiply_transposed(x));
}

}  // namespace whirl::solve
