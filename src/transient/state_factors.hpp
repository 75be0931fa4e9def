#pragma once
// LU factors of the sparse matrix of a film's own states, made again and again on one pattern.

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <memory>

#include "whirl/core/petsc.hpp"

namespace whirl::transient {

/// x = S^-1 y. PETSc's LU in an order of nested dissection, which takes no pivots: on a mesh of 96 x 32 cells it has
/// 0.6 times the entries of Eigen's with pivots, takes a third of the time to make and half of the time to use. One
/// solve tells whether digits were lost; from then on pivots are taken. Single rank.
class StateFactors {
public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// Throws core::NotConverged if S is singular.
  void compute(const Matrix& s);
  /// x may be y.
  void solve(const double* y, double* x) const;
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& y) const;
  [[nodiscard]] bool takes_pivots() const { return pivoted_ != nullptr; }

private:
  using ByRows = Eigen::SparseMatrix<double, Eigen::RowMajor, PetscInt>;
  [[nodiscard]] bool without_pivots(const Matrix& s);
  void set_pattern(const ByRows& rows);

  ByRows rows_;  // the pattern, and the values of the last matrix
  core::Matrix matrix_, factors_;
  core::Vector from_, to_;
  Eigen::VectorXd work_;
  std::unique_ptr<Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>>> pivoted_;
};

}  // namespace whirl::transient
