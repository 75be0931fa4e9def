#pragma once
// Small dense bordered systems.

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>

namespace whirl::solve {

/// [A b; c^T 0][v; g] = [0; I] and its transpose for A [n x n] that loses rank by the number k of columns of b and c
/// [n x k]: v, w [n x k], g [k x k].
class Bordered {
public:
  /// Borders that are generic and the same everywhere.
  Bordered(Eigen::Index n, Eigen::Index k) : b_(n, k), c_(n, k) {
    for (Eigen::Index j = 0; j < k; ++j)
      for (Eigen::Index i = 0; i < n; ++i) {
        b_(i, j) = std::sin(1.0 + static_cast<double>(i + n * j));
        c_(i, j) = std::cos(2.0 + static_cast<double>(i) + static_cast<double>(n * j) / 3);
      }
    orthonormalise(b_);
    orthonormalise(c_);
  }
  void solve(const Eigen::MatrixXd& a) {
    const Eigen::Index n = a.rows(), k = b_.cols();
    Eigen::MatrixXd whole(n + k, n + k);
    // The border in the size of A, so that neither disturbs the pivots of the other.
    const double size = std::max(a.norm() / std::sqrt(static_cast<double>(n)), 1e-300);
    whole << a, size * b_, size * c_.transpose(), Eigen::MatrixXd::Zero(k, k);
    const Eigen::PartialPivLU<Eigen::MatrixXd> lu(whole);
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(n + k, k);
    unit.bottomRows(k) = size * Eigen::MatrixXd::Identity(k, k);
    const Eigen::MatrixXd right = lu.solve(unit), left = lu.transpose().solve(unit);
    v = right.topRows(n);
    w = left.topRows(n);
    g = size * right.bottomRows(k);
  }
  /// The null vectors found last as borders.
  void update() {
    b_ = w;
    c_ = v;
    orthonormalise(b_);
    orthonormalise(c_);
  }

  Eigen::MatrixXd v, w, g;

private:
  static void orthonormalise(Eigen::MatrixXd& m) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) {
      for (Eigen::Index i = 0; i < j; ++i) m.col(j) -= m.col(i).dot(m.col(j)) * m.col(i);
      m.col(j).normalize();
    }
  }
  Eigen::MatrixXd b_, c_;
};

}  // namespace whirl::solve
