#pragma once
// The matrices of one stage of a Runge-Kutta step, distributed in space.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>

#include "whirl/core/petsc.hpp"
#include "whirl/problem/frozen.hpp"

namespace whirl::solve {

/// matrix^-1, to rounding: entry by entry where each row and column has one entry (masses beside rates q'); exact LU
/// (on each rank, for small matrices); GMRES with block Jacobi for large ones on several ranks (PETSc prefix "stage_").
/// Collective on the matrix' communicator.
class StageSolver {
public:
  explicit StageSolver(core::Matrix matrix);
  void solve(Vec rhs, Vec x) const;
  /// The matrix is one entry 1/inverse()(i) in local row i at local column column()(i), on every rank.
  [[nodiscard]] bool entrywise() const { return !solver_; }
  [[nodiscard]] const Eigen::VectorXd& inverse() const { return inverse_; }
  [[nodiscard]] const Eigen::VectorX<PetscInt>& column() const { return column_; }

private:
  core::Matrix matrix_;
  core::LinearSolver solver_;
  Eigen::VectorXd inverse_;
  Eigen::VectorX<PetscInt> column_;
};

/// k = -(dF/d(dx/dt) + H a(j,j) dF/dx)^-1 (dF/dx w + g), of one stage, for this rank's rows. Collective.
class StageProduct {
public:
  /// Of dF/dx, which is kept.
  StageProduct(core::Matrix jx, std::shared_ptr<const StageSolver> solver)
      : solver_(std::move(solver)), jx_(std::move(jx)) {}
  /// Of dF/dx on one rank and a solver that inverts entry by entry: only their product is kept.
  StageProduct(Mat jx, std::shared_ptr<const StageSolver> solver);
  /// Of the equations A = dF/d(dx/dt) + own dF/dx, own = H a(j,j) > 0, of a system that solves them itself; `like`
  /// gives the layout of its states.
  StageProduct(std::shared_ptr<const problem::Frozen> frozen, double own, Vec like);
  /// All columns of w [local x k] at once; `load` g may be null, else w has one column.
  [[nodiscard]] Eigen::MatrixXd slope(const Eigen::MatrixXd& w, const Eigen::VectorXd* load) const;

private:
  [[nodiscard]] Eigen::MatrixXd frozen_slope(const Eigen::MatrixXd& w, const Eigen::VectorXd* load) const;
  std::shared_ptr<const StageSolver> solver_;
  std::shared_ptr<const problem::Frozen> frozen_;
  double own_ = 0;
  core::Vector like_;  // of the frozen equations
  core::Matrix jx_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> direct_;  // the product, if there is neither
};

}  // namespace whirl::solve
