#pragma once
// LU of a sparse matrix whose entries lie near its diagonal.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

namespace whirl::film {

/// P D A = L U by LAPACK (dgbtrf) of matrices of one pattern, D such that the largest entry of each row is one: rows of
/// films have several units. Cost for n states of bandwidth w on either side: up to 4 n w^2 operations to factorise,
/// 6 n w to solve, 3 n w numbers to hold.
class BandLu {
public:
  using Sparse = Eigen::SparseMatrix<double>;
  explicit BandLu(const Sparse& pattern);
  /// Largest distance of an entry from the diagonal.
  [[nodiscard]] static int bandwidth(const Sparse& pattern);
  /// Whether this costs less than a sparse LU of a mesh in two directions, by counts.
  [[nodiscard]] static bool pays(const Sparse& pattern);
  /// Of a matrix with that pattern; false if it is singular.
  [[nodiscard]] bool factor(const Sparse& a);
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  [[nodiscard]] Eigen::VectorXd solve_transposed(const Eigen::VectorXd& b) const;

private:
  [[nodiscard]] Eigen::VectorXd solved(char which, Eigen::VectorXd b) const;
  int size_, width_, stride_;
  std::vector<double> band_;
  std::vector<int> rows_;  // exchanged
  Eigen::VectorXd scale_;  // D
};

}  // namespace whirl::film
