#include <Eigen/LU>

#include "whirl/solve/cycle/interval.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class LowRankInterval final : public Interval {
public:
  LowRankInterval(std::shared_ptr<const LinearPart> part, std::vector<MatrixXd> tangents)
      : part_(std::move(part)), s_(std::move(tangents)) {
    const Index m = part_->scheme.degree;
    k_.compute(MatrixXd::Identity(m * part_->r, m * part_->r) - times_s(part_->vy));
  }
  void solve(MatrixXd& y) const override {
    part_->solve(y);
    y.noalias() += part_->y * k_.solve(times_s(part_->inputs(y)));
  }
  void solve_transposed(MatrixXd& y) const override {
    // A^-T y = W0^-T (y + V^T S^T K^-T Y^T y)
    const MatrixXd t = k_.transpose().solve(part_->y.transpose() * y);
    y += part_->inputs_transposed(times_s_transposed(t));
    part_->solve_transposed(y);
  }
  void carry(const MatrixXd& rows, MatrixXd& state, MatrixXd& added) const override {
    if (state.cols() < part_->n) return Interval::carry(rows, state, added);
    MatrixXd adjoint = rows.transpose();
    solve_transposed(adjoint);
    added.noalias() -= start_transposed(adjoint).transpose() * state;
    state = (transition() * state).eval();
  }
  MatrixXd start(const MatrixXd& x) const override {
    MatrixXd y = part_->w00 * x;
    const MatrixXd inputs = part_->c * x;
    for (int j = 0; j < part_->scheme.degree; ++j)
      y.middleRows(j * part_->n, part_->n).noalias() -=
          part_->b * (s_[static_cast<std::size_t>(j)] * inputs) * part_->scheme.value(j, 0);
    return y;
  }
  MatrixXd start_transposed(const MatrixXd& y) const override {
    MatrixXd x = part_->w00.transpose() * y;
    for (int j = 0; j < part_->scheme.degree; ++j)
      x.noalias() -= part_->c.transpose() *
                     (s_[static_cast<std::size_t>(j)].transpose() *
                      (part_->b.transpose() * y.middleRows(j * part_->n, part_->n))) *
                     part_->scheme.value(j, 0);
    return x;
  }
  VectorXd multiply(const VectorXd& x_start, const VectorXd& x) const override {
    const auto& p = *part_;
    VectorXd y(p.scheme.degree * p.n);
    for (Index j = 0; j < p.scheme.degree; ++j) {
      VectorXd value = p.scheme.value(j, 0) * x_start, slope = p.scheme.slope(j, 0) * x_start;
      for (Index l = 1; l <= p.scheme.degree; ++l) {
        value += p.scheme.value(j, l) * x.segment((l - 1) * p.n, p.n);
        slope += p.scheme.slope(j, l) * x.segment((l - 1) * p.n, p.n);
      }
      y.segment(j * p.n, p.n) =
          p.l0 * value + p.l1 * (slope / p.length) - p.b * (s_[static_cast<std::size_t>(j)] * (p.c * value));
    }
    return y;
  }
  MatrixXd block(int j, int l) const override {
    const auto& p = *part_;
    return p.scheme.value(j, l) * (p.l0 - p.b * s_[static_cast<std::size_t>(j)] * p.c) +
           (p.scheme.slope(j, l) / p.length) * p.l1;
  }

private:
  // Gamma = -E A^-1 A0 [n x n], E the last block row.
  MatrixXd transition() const {
    return part_->free.bottomRows(part_->n) + part_->y.bottomRows(part_->n) * k_.solve(times_s(part_->inputs_free));
  }
  // S v for v [mw x k], block by block.
  MatrixXd times_s(const MatrixXd& v) const {
    const Index r = part_->r, w = part_->w;
    MatrixXd out(part_->scheme.degree * r, v.cols());
    for (Index j = 0; j < part_->scheme.degree; ++j)
      out.middleRows(j * r, r).noalias() = s_[static_cast<std::size_t>(j)] * v.middleRows(j * w, w);
    return out;
  }
  MatrixXd times_s_transposed(const MatrixXd& v) const {
    const Index r = part_->r, w = part_->w;
    MatrixXd out(part_->scheme.degree * w, v.cols());
    for (Index j = 0; j < part_->scheme.degree; ++j)
      out.middleRows(j * w, w).noalias() = s_[static_cast<std::size_t>(j)].transpose() * v.middleRows(j * r, r);
    return out;
  }

  std::shared_ptr<const LinearPart> part_;
  std::vector<MatrixXd> s_;
  Eigen::PartialPivLU<MatrixXd> k_;
};

}  // namespace

std::unique_ptr<Interval> make_low_rank_interval(std::shared_ptr<const LinearPart> part,
                                                 std::vector<MatrixXd> tangents) {
  return std::make_unique<LowRankInterval>(std::move(part), std::move(tangents));
}

}  // namespace whirl::solve
