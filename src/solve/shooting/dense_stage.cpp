// Stages by dense matrices.

#include "whirl/core/dense_lu.hpp"
#include "whirl/solve/shooting/runge_kutta.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class DenseStage final : public Stage {
public:
  DenseStage(problem::ScaledPoint& point, long& count) : point_(point), count_(count) {}

  void residual(const StageGroup& group, In x, In k, Out f, bool) override {
    for (Index j = 0; j < x.cols(); ++j) point_.residual(group.angle(j), x.col(j), k.col(j), f.col(j));
  }

  void factorise(const StageGroup& group, In x, In k) override { linearise(group, x, k, false); }

  void solve(Out f, double) override {
    Map<VectorXd> all(f.data(), f.size());
    all = lu_.solve(all);
  }

  void keep(const StageGroup& group, In x, In k) override { linearise(group, x, k, true); }

  void slopes(In w, bool loaded, Out dk) override {
    const Index n = jx_.rows();
    MatrixXd rhs(w.rows(), w.cols());
    for (Index j = 0; j < w.rows() / n; ++j)
      rhs.middleRows(j * n, n).noalias() = -jx_.middleCols(j * n, n) * w.middleRows(j * n, n);
    if (loaded) rhs.rightCols(1) -= load_;
    dk = lu_.solve(rhs);
  }

private:
  // dF/dx is needed for slopes() only.
  void linearise(const StageGroup& group, In x, In k, bool kept) {
    const Index n = x.rows(), m = x.cols();
    MatrixXd matrix(m * n, m * n), jx, jxdot;
    VectorXd load;
    if (kept) {
      jx_.resize(n, m * n);
      load_.resize(m * n);
    }
    for (Index j = 0; j < m; ++j) {
      point_.linearise(group.angle(j), x.col(j), k.col(j), jx, jxdot, kept ? &load : nullptr);
      for (Index l = 0; l < m; ++l) matrix.block(j * n, l * n, n, n) = group.own(j, l) * jx;
      matrix.block(j * n, j * n, n, n) += jxdot;
      if (!kept) continue;
      jx_.middleCols(j * n, n) = jx;
      load_.segment(j * n, n) = load;
    }
    lu_.compute(matrix);
    ++count_;
  }

  problem::ScaledPoint& point_;
  long& count_;               // of factorisations
  core::DenseLu<double> lu_;  // of all stages together
  MatrixXd jx_;               // side by side [n x n m]
  VectorXd load_;             // dF/dp
};

class DenseStages final : public Stages {
public:
  explicit DenseStages(problem::ScaledPoint& point) : point_(point) {}
  std::unique_ptr<Stage> make() override { return std::make_unique<DenseStage>(point_, factorisations_); }

private:
  problem::ScaledPoint& point_;
};

}  // namespace

std::unique_ptr<Stages> dense_stages(problem::ScaledPoint& point) {
  return std::make_unique<DenseStages>(point);
}

}  // namespace whirl::solve
