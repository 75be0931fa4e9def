#include "solve/shooting/stage_solver.hpp"

#include <vector>

#include "solve/newton/local_part.hpp"
#include "solve/newton/port_krylov.hpp"
#include "whirl/core/matrix_rows.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Of the right-hand side, of products with derivatives of steps.
constexpr double product_tolerance = 1e-9;

// Fills the places of the only entries of rows and columns, all on their own rank; false if the matrix has others.
bool find_entries(MPI_Comm comm, Mat matrix, VectorXd& inverse, Eigen::VectorX<PetscInt>& column) {
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(matrix, &begin, &end));
  inverse.setZero(end - begin);
  column.setConstant(end - begin, -1);
  std::vector<bool> taken(static_cast<std::size_t>(end - begin), false);
  int single = 1;
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(matrix, i, &count, &columns, &values));
    for (PetscInt k = 0; k < count; ++k) {
      if (values[k] == 0) continue;
      const PetscInt c = columns[k] - begin;
      if (c < 0 || c >= end - begin || column(i - begin) >= 0 || taken[static_cast<std::size_t>(c)]) {
        single = 0;
        continue;
      }
      taken[static_cast<std::size_t>(c)] = true;
      column(i - begin) = c;
      inverse(i - begin) = 1 / values[k];
    }
    if (column(i - begin) < 0) single = 0;
    check(MatRestoreRow(matrix, i, &count, &columns, &values));
  }
  MPI_Allreduce(MPI_IN_PLACE, &single, 1, MPI_INT, MPI_MIN, comm);
  return single != 0;
}

// Up to this many states the making of a solver of PETSc takes longer than all of the arithmetic.
constexpr PetscInt small = 64;

// Solves to rounding, so that products are exact: factorised on every rank, with one step of refinement for what LU
// without pivoting loses. No reductions, which cost more than the arithmetic of a machine without parts.
core::LinearSolver make_solver(MPI_Comm comm, Mat matrix) {
  core::LinearSolver solver;
  check(KSPCreate(comm, solver.put()));
  KSP ksp = solver.get();
  PC pc = nullptr;
  check(KSPSetOptionsPrefix(ksp, "stage_"));
  check(KSPSetOperators(ksp, matrix, matrix));
  check(KSPGetPC(ksp, &pc));
  check(KSPSetType(ksp, KSPRICHARDSON));
  check(KSPSetNormType(ksp, KSP_NORM_NONE));
  check(KSPSetConvergenceTest(ksp, KSPConvergedSkip, nullptr, nullptr));
  check(KSPSetTolerances(ksp, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 2));
  check(PCSetType(pc, core::size_of(comm) == 1 ? PCLU : PCREDUNDANT));
  check(KSPSetFromOptions(ksp));
  check(KSPSetUp(ksp));
  return solver;
}

}  // namespace

StageSolver::StageSolver(core::Matrix matrix) : matrix_(std::move(matrix)) {
  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(matrix_.get()));
  if (find_entries(comm, matrix_.get(), inverse_, column_)) return;
  PetscInt n = 0;
  check(MatGetSize(matrix_.get(), &n, nullptr));
  if (core::size_of(comm) == 1 && n <= small)
    dense_.emplace(core::dense(matrix_.get()));
  else
    solver_ = make_solver(comm, matrix_.get());
}

bool StageSolver::entrywise(Mat matrix) {
  VectorXd inverse;
  Eigen::VectorX<PetscInt> column;
  return find_entries(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), matrix, inverse, column);
}

void StageSolver::solve(Vec rhs, Vec x, double tolerance) const {
  if (blocks_) {
    (void)krylov_->solve(*blocks_, *similar_, rhs, x, tolerance);
    return;
  }
  if (solver_) {
    check(KSPSolve(solver_.get(), rhs, x));
    return;
  }
  const core::ReadArray b(rhs);
  const core::WriteArray a(x);
  if (dense_) {
    const auto n = static_cast<Index>(b.size());
    Eigen::Map<VectorXd>(a.data(), n) = dense_->solve(Eigen::Map<const VectorXd>(b.data(), n));
    return;
  }
  for (Index i = 0; i < inverse_.size(); ++i) a[column_(i)] = inverse_(i) * b[static_cast<PetscInt>(i)];
}

StageProduct::StageProduct(Mat jx, std::shared_ptr<const StageSolver> solver) : solver_(std::move(solver)) {
  const Index n = solver_->column().size();
  Eigen::VectorX<PetscInt> row(n);
  for (Index i = 0; i < n; ++i) row(solver_->column()(i)) = static_cast<PetscInt>(i);
  direct_.resize(n, n);
  for (Index c = 0; c < n; ++c) {
    PetscInt count = 0;
    const PetscInt* column = nullptr;
    const PetscScalar* value = nullptr;
    check(MatGetRow(jx, row(c), &count, &column, &value));
    direct_.startVec(c);
    for (PetscInt k = 0; k < count; ++k)
      if (value[k] != 0) direct_.insertBack(c, column[k]) = -solver_->inverse()(row(c)) * value[k];
    check(MatRestoreRow(jx, row(c), &count, &column, &value));
  }
  direct_.finalize();
}

core::Vector StageProduct::reference(Vec v) {
  check(PetscObjectReference(reinterpret_cast<PetscObject>(v)));
  return core::Vector(v);
}

MatrixXd StageProduct::slope(const MatrixXd& w, const VectorXd* load) const {
  if (!jx_ && !rates_) {
    MatrixXd k = direct_ * w;
    for (Index i = 0; load && i < k.rows(); ++i) k(solver_->column()(i), 0) -= solver_->inverse()(i) * (*load)(i);
    return k;
  }
  MatrixXd out(w.rows(), w.cols());
  const core::Vector x = core::duplicate(like_.get()), f = core::duplicate(like_.get());
  for (Index c = 0; c < w.cols(); ++c) {
    put(w.col(c), x.get());
    if (jx_) {
      check(MatMult(jx_.get(), x.get(), f.get()));
    } else {
      // own dF/dx w = A w - dF/d(dx/dt) w
      VectorXd moved(w.rows()), rates(w.rows());
      solver_->blocks()->multiply(w.col(c).data(), moved.data());
      rates_->multiply(w.col(c).data(), rates.data());
      put((moved - rates) / own_, f.get());
    }
    if (load) {
      put(*load, x.get());
      check(VecAXPY(f.get(), 1, x.get()));
    }
    solver_->solve(f.get(), x.get(), product_tolerance);
    out.col(c) = -get(x.get());
  }
  return out;
}

}  // namespace whirl::solve
