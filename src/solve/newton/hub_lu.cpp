#include "solve/newton/hub_lu.hpp"

#include <limits>

#include "whirl/core/dense_lu.hpp"

namespace whirl::solve {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Eigen::Index dense_until = 160;

// Whether `inverse` of `m` is one beyond rounding. The largest entry of diag(|M| |M^-1|), a condition number that no
// scale of rows or columns changes, tells how much rounding grows: without bound where columns depend on each other,
// which elimination turns into a zero or into what rounding leaves of one.
bool is_regular(const MatrixXd& m, const MatrixXd& inverse) {
  if (!inverse.allFinite()) return false;
  constexpr double most = 1e-2 / std::numeric_limits<double>::epsilon();
  return m.cwiseAbs().cwiseProduct(inverse.transpose().cwiseAbs()).rowwise().sum().maxCoeff() < most;
}

}  // namespace

bool HubLu::factorise(const problem::SparseBlock& m, const problem::SparseBlock& b, const problem::SparseBlock& c) {
  if (m.rows() <= dense_until) {
    const MatrixXd whole(m);
    inverse_ = core::DenseLu<double>(whole).inverse();
    if (!is_regular(whole, inverse_)) return false;
    lead_.noalias() = inverse_ * b;
  } else {
    if (!sparse_.compute(m)) return false;
    lead_ = sparse_.solve(MatrixXd(b));
  }
  seen_ = c * lead_;
  return true;
}

void HubLu::solve(const VectorXd& y, Eigen::Ref<VectorXd> x) const {
  if (inverse_.size() > 0)
    x.noalias() = inverse_ * y;
  else
    sparse_.solve(y.data(), x.data(), 1);
}

void HubLu::solve_transposed(const VectorXd& y, Eigen::Ref<VectorXd> x) const {
  if (inverse_.size() > 0)
    x.noalias() = inverse_.transpose() * y;
  else
    sparse_.solve_transposed(y.data(), x.data(), 1);
}

}  // namespace whirl::solve
