#pragma once
// Sparse direct solution on one rank, made again and again on one pattern.

#include <Eigen/SparseCore>
#include <optional>

#include "whirl/core/petsc.hpp"
#include "whirl/core/pivoted_lu.hpp"

namespace whirl::core {

/// A^-1 of a sparse matrix. PETSc's LU in an order of nested dissection, which takes no pivots: on a film of 192 x 64
/// cells it has half the entries of Eigen's with pivots, takes a third of the time to make and half of the time to use.
/// One solve tells whether digits were lost; from then on this object takes pivots.
class SparseLu {
public:
  using Matrix = Eigen::SparseMatrix<double>;

  /// False if A is singular; nothing can be solved then.
  [[nodiscard]] bool compute(const Matrix& a);
  /// x = A^-1 y, arrays that do not overlap.
  void solve(const double* y, double* x) const;
  /// A^-1 y and A^-T y of all columns.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& y) const;
  [[nodiscard]] Eigen::MatrixXd solve_transposed(const Eigen::MatrixXd& y) const;
  [[nodiscard]] bool takes_pivots() const { return pivoted_.has_value(); }

private:
  using ByRows = Eigen::SparseMatrix<double, Eigen::RowMajor, PetscInt>;

  [[nodiscard]] bool without_pivots(const Matrix& a);
  void set_pattern(const ByRows& rows);
  void apply(PetscErrorCode (*by)(Mat, Vec, Vec), const double* y, double* x) const;

  ByRows rows_;  // the pattern
  core::Matrix matrix_, factors_;
  Vector from_, to_;
  std::optional<PivotedLu<double>> pivoted_;
};

}  // namespace whirl::core
