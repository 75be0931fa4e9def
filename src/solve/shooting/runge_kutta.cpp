#include "whirl/solve/shooting/runge_kutta.hpp"

#include <vector>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int max_iterations = 20;

// Newton converges quadratically: a correction this small leaves an error at the level of rounding.
bool arrived(const VectorXd& d_slope, double length, const VectorXd& x) {
  return length * d_slope.lpNorm<Eigen::Infinity>() <= 1e-9 * (1 + x.lpNorm<Eigen::Infinity>());
}

[[noreturn]] void fail() {
  throw core::DomainError("a stage of the Runge-Kutta step was not solved");
}

}  // namespace

// One stage whose earlier slopes are known.
void RungeKutta::solve_stage(Index j, double angle, double length, const VectorXd& x, MatrixXd& slopes) {
  const double own = tableau_.a(j, j);
  VectorXd base = x, f(x.size()), k = j > 0 ? VectorXd(slopes.col(j - 1)) : VectorXd::Zero(x.size());
  base += length * (slopes.leftCols(j) * tableau_.a.row(j).head(j).transpose());
  MatrixXd jx, jxdot;
  for (int it = 0;; ++it) {
    const VectorXd value = base + length * own * k;
    point_.residual(angle, value, k, f);
    point_.linearise(angle, value, k, jx, jxdot, nullptr);
    if (own != 0) jxdot += length * own * jx;
    const VectorXd d = -core::DenseLu<double>(jxdot).solve(f);
    k += d;
    // F is linear in dx/dt, so that an explicit stage is solved at once.
    if (own == 0 || arrived(d, length, x)) break;
    if (it == max_iterations || !d.allFinite()) fail();
  }
  if (!k.allFinite()) fail();
  slopes.col(j) = k;
}

void RungeKutta::solve_coupled(double angle, double d_angle, double length, const VectorXd& x, MatrixXd& slopes) {
  const Index n = x.size(), s = tableau_.stages();
  MatrixXd matrix(s * n, s * n), jx, jxdot;
  VectorXd f(s * n);
  slopes.setZero();
  for (int it = 0;; ++it) {
    for (Index j = 0; j < s; ++j) {
      const VectorXd value = x + length * (slopes * tableau_.a.row(j).transpose()), k = slopes.col(j);
      const double at = angle + tableau_.c(j) * d_angle;
      point_.residual(at, value, k, f.segment(j * n, n));
      point_.linearise(at, value, k, jx, jxdot, nullptr);
      for (Index l = 0; l < s; ++l) matrix.block(j * n, l * n, n, n) = length * tableau_.a(j, l) * jx;
      matrix.block(j * n, j * n, n, n) += jxdot;
    }
    const VectorXd d = -core::DenseLu<double>(matrix).solve(f);
    slopes += Eigen::Map<const MatrixXd>(d.data(), n, s);
    if (arrived(d, length, x)) break;
    if (it == max_iterations || !d.allFinite()) fail();
  }
}

// dF/dx dX_j + dF/dxdot dK_j + dF/dp = 0 with dX_j = dx_0 + sum_l a(j,l) (H dK_l + dH K_l), for all columns at once.
MatrixXd RungeKutta::tangents_of(double angle, double d_angle, double length, const VectorXd& x,
                                 const MatrixXd& slopes) {
  const Index n = x.size(), s = tableau_.stages();
  const bool sequential = tableau_.sequential();
  MatrixXd matrix, rhs(s * n, n + 2), jx, jxdot;
  if (!sequential) matrix.resize(s * n, s * n);
  VectorXd d_parameter;
  for (Index j = 0; j < s; ++j) {
    const VectorXd lift = slopes * tableau_.a.row(j).transpose(), value = x + length * lift;
    point_.linearise(angle + tableau_.c(j) * d_angle, value, slopes.col(j), jx, jxdot, &d_parameter);
    auto own = rhs.middleRows(j * n, n);
    own.leftCols(n) = -jx;
    own.col(n).noalias() = -(jx * lift);
    own.col(n + 1) = -d_parameter;
    if (sequential) {
      MatrixXd known = MatrixXd::Zero(n, n + 2);
      for (Index l = 0; l < j; ++l)
        if (tableau_.a(j, l) != 0) known += length * tableau_.a(j, l) * rhs.middleRows(l * n, n);
      own.noalias() -= jx * known;
      if (tableau_.a(j, j) != 0) jxdot += length * tableau_.a(j, j) * jx;
      own = core::DenseLu<double>(jxdot).solve(own);
    } else {
      for (Index l = 0; l < s; ++l) matrix.block(j * n, l * n, n, n) = length * tableau_.a(j, l) * jx;
      matrix.block(j * n, j * n, n, n) += jxdot;
    }
  }
  if (!sequential) rhs = core::DenseLu<double>(matrix).solve(rhs);
  MatrixXd out = MatrixXd::Identity(n, n + 2);
  for (Index j = 0; j < s; ++j) out += length * tableau_.b(j) * rhs.middleRows(j * n, n);
  out.col(n) += slopes * tableau_.b;
  return out;
}

void RungeKutta::step(double angle, double d_angle, double length, VectorXd& x, MatrixXd* tangents) {
  MatrixXd slopes = MatrixXd::Zero(x.size(), tableau_.stages());
  if (tableau_.sequential())
    for (Index j = 0; j < tableau_.stages(); ++j) solve_stage(j, angle + tableau_.c(j) * d_angle, length, x, slopes);
  else
    solve_coupled(angle, d_angle, length, x, slopes);
  if (tangents) *tangents = tangents_of(angle, d_angle, length, x, slopes);
  x += length * (slopes * tableau_.b);
}

}  // namespace whirl::solve
