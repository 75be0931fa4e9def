#include "whirl/solve/cycle/interval.hpp"

#include "whirl/core/dense_lu.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class DenseInterval final : public Interval {
public:
  DenseInterval(const Scheme& scheme, double length, const std::vector<MatrixXd>& jx,
                const std::vector<MatrixXd>& jxdot) {
    const Index n = jx[0].rows(), m = scheme.degree;
    a_.resize(m * n, m * n);
    a0_.resize(m * n, n);
    for (Index j = 0; j < m; ++j)
      for (Index l = 0; l <= m; ++l) {
        const auto k = static_cast<std::size_t>(j);
        Eigen::Block<MatrixXd> out = l == 0 ? a0_.block(j * n, 0, n, n) : a_.block(j * n, (l - 1) * n, n, n);
        out = scheme.value(j, l) * jx[k] + (scheme.slope(j, l) / length) * jxdot[k];
      }
    lu_.compute(a_);
  }
  void solve(MatrixXd& y) const override { y = lu_.solve(y); }
  void solve_transposed(MatrixXd& y) const override { y = lu_.solve_transposed(y); }
  MatrixXd start(const MatrixXd& x) const override { return a0_ * x; }
  MatrixXd start_transposed(const MatrixXd& y) const override { return a0_.transpose() * y; }
  VectorXd multiply(const VectorXd& x_start, const VectorXd& x) const override {
    VectorXd y = a_ * x;
    y.noalias() += a0_ * x_start;
    return y;
  }
  MatrixXd block(int j, int l) const override {
    const Index n = a0_.cols();
    return l == 0 ? MatrixXd(a0_.middleRows(j * n, n)) : MatrixXd(a_.block(j * n, (l - 1) * n, n, n));
  }

private:
  MatrixXd a_, a0_;
  core::DenseLu<double> lu_;
};

}  // namespace

void Interval::carry(const MatrixXd& rows, MatrixXd& state, MatrixXd& added) const {
  MatrixXd x = -start(state);
  solve(x);
  added.noalias() += rows * x;
  state = x.bottomRows(state.rows());
}

std::unique_ptr<Interval> make_dense_interval(const Scheme& scheme, double length, std::vector<MatrixXd> jx,
                                              std::vector<MatrixXd> jxdot) {
  return std::make_unique<DenseInterval>(scheme, length, jx, jxdot);
}

}  // namespace whirl::solve
