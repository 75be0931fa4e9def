#pragma once
// The matrices of one stage of a Runge-Kutta step, distributed in space.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <optional>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::solve {

class PortElimination;
class PortKrylov;
class PortMatrix;

/// matrix^-1: entry by entry where each row and column has one entry (masses beside rates q'); by FGMRES and the
/// elimination of the parts of a similar matrix; or by LU, on each rank where there are several, and as a dense matrix
/// if it is small and on one rank. All but the first and the last read PETSc options with the prefix "stage_".
/// Collective on the matrix' communicator.
class StageSolver {
public:
  /// Entry by entry or by LU.
  explicit StageSolver(core::Matrix matrix);
  StageSolver(std::shared_ptr<const PortMatrix> blocks, std::shared_ptr<PortElimination> similar,
              std::shared_ptr<PortKrylov> krylov)
      : blocks_(std::move(blocks)), similar_(std::move(similar)), krylov_(std::move(krylov)) {}
  /// To the relative residual `tolerance` where it iterates, else to rounding.
  void solve(Vec rhs, Vec x, double tolerance) const;
  /// The matrix is one entry 1/inverse()(i) in local row i at local column column()(i), on every rank.
  [[nodiscard]] bool entrywise() const { return !solver_ && !dense_ && !blocks_; }
  /// Whether a matrix is of this kind. Collective.
  [[nodiscard]] static bool entrywise(Mat matrix);
  [[nodiscard]] const Eigen::VectorXd& inverse() const { return inverse_; }
  [[nodiscard]] const Eigen::VectorX<PetscInt>& column() const { return column_; }
  /// The matrix in blocks; null where it is not solved by elimination.
  [[nodiscard]] const std::shared_ptr<const PortMatrix>& blocks() const { return blocks_; }

private:
  core::Matrix matrix_;
  core::LinearSolver solver_;
  std::optional<core::DenseLu<double>> dense_;
  Eigen::VectorXd inverse_;
  Eigen::VectorX<PetscInt> column_;
  std::shared_ptr<const PortMatrix> blocks_;
  std::shared_ptr<PortElimination> similar_;
  std::shared_ptr<PortKrylov> krylov_;
};

/// k = -(dF/d(dx/dt) + H a(j,j) dF/dx)^-1 (dF/dx w + g), of one stage, for this rank's rows. Collective.
class StageProduct {
public:
  /// Of dF/dx, which is kept; `like` has the layout of the states and is referred to.
  StageProduct(core::Matrix jx, std::shared_ptr<const StageSolver> solver, Vec like)
      : solver_(std::move(solver)), jx_(std::move(jx)), like_(reference(like)) {}
  /// Of dF/dx on one rank and a solver that inverts entry by entry: only their product is kept.
  StageProduct(Mat jx, std::shared_ptr<const StageSolver> solver);
  /// Of the blocks A = dF/d(dx/dt) + own dF/dx of `solver`, own = H a(j,j) > 0, and those of dF/d(dx/dt).
  StageProduct(std::shared_ptr<const StageSolver> solver, std::shared_ptr<const PortMatrix> rates, double own, Vec like)
      : solver_(std::move(solver)), rates_(std::move(rates)), own_(own), like_(reference(like)) {}
  /// All columns of w [local x k] at once; `load` g may be null, else w has one column.
  [[nodiscard]] Eigen::MatrixXd slope(const Eigen::MatrixXd& w, const Eigen::VectorXd* load) const;

private:
  [[nodiscard]] static core::Vector reference(Vec v);
  std::shared_ptr<const StageSolver> solver_;
  std::shared_ptr<const PortMatrix> rates_;
  double own_ = 0;
  core::Matrix jx_;
  core::Vector like_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> direct_;  // the product, if there is neither
};

}  // namespace whirl::solve
