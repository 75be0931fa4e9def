#include "solve/sparse_step.hpp"

#include <cmath>
#include <cstdlib>

#include "whirl/core/agree.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;

namespace {

std::size_t at(Index i) {
  return static_cast<std::size_t>(i);
}

constexpr PetscInt direct_below = 3000;
constexpr double product_tolerance = 1e-9, newton_tolerance = 1e-5;  // of frozen equations

bool is_diagonal(MPI_Comm comm, Mat matrix) {
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(matrix, &begin, &end));
  int diagonal = 1;
  for (PetscInt i = begin; i < end; ++i) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(matrix, i, &count, &columns, &values));
    for (PetscInt k = 0; k < count; ++k)
      if (columns[k] != i && values[k] != 0) diagonal = 0;
    check(MatRestoreRow(matrix, i, &count, &columns, &values));
  }
  MPI_Allreduce(MPI_IN_PLACE, &diagonal, 1, MPI_INT, MPI_MIN, comm);
  return diagonal != 0;
}

// The block Jacobi of large matrices solves its blocks exactly.
void exact_blocks(PC pc) {
  PetscBool blocks = PETSC_FALSE;
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCBJACOBI, &blocks));
  if (!blocks) return;
  PetscInt count = 0;
  KSP* sub = nullptr;
  check(PCBJacobiGetSubKSP(pc, &count, nullptr, &sub));
  for (PetscInt i = 0; i < count; ++i) {
    PC inner = nullptr;
    check(KSPGetPC(sub[i], &inner));
    check(PCSetType(inner, PCLU));
  }
}

// Solves to rounding, so that products are exact. Small matrices are factorised, on every rank if there are several,
// with one step of refinement for what LU without pivoting loses: no reductions, which cost more than the arithmetic.
std::shared_ptr<const core::LinearSolver> make_solver(MPI_Comm comm, Mat matrix) {
  auto solver = std::make_shared<core::LinearSolver>();
  check(KSPCreate(comm, solver->put()));
  KSP ksp = solver->get();
  PC pc = nullptr;
  PetscInt n = 0;
  check(MatGetSize(matrix, &n, nullptr));
  check(KSPSetOptionsPrefix(ksp, "stage_"));
  check(KSPSetOperators(ksp, matrix, matrix));
  check(KSPGetPC(ksp, &pc));
  const bool alone = core::size_of(comm) == 1;
  if (is_diagonal(comm, matrix)) {
    check(KSPSetType(ksp, KSPPREONLY));
    check(PCSetType(pc, PCJACOBI));
  } else if (alone || n < direct_below) {
    check(KSPSetType(ksp, KSPRICHARDSON));
    check(KSPSetNormType(ksp, KSP_NORM_NONE));
    check(KSPSetConvergenceTest(ksp, KSPConvergedSkip, nullptr, nullptr));
    check(KSPSetTolerances(ksp, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 2));
    check(PCSetType(pc, alone ? PCLU : PCREDUNDANT));
  } else {
    check(KSPSetType(ksp, KSPGMRES));
    check(KSPSetTolerances(ksp, 1e-13, 1e-300, PETSC_DEFAULT, 200));
    check(PCSetType(pc, PCBJACOBI));
  }
  check(KSPSetFromOptions(ksp));
  check(KSPSetUp(ksp));
  exact_blocks(pc);
  return solver;
}

}  // namespace

void StepProduct::stages(Vec v, const std::vector<core::Vector>& lift, const std::vector<core::Vector>& load,
                         Vec out) const {
  const std::vector<core::Vector>& k = work_->k;
  Vec w = work_->w.get(), rhs = work_->rhs.get();
  for (Index j = 0; j < tableau_->stages(); ++j) {
    const Stage& stage = stages_[at(j)];
    check(VecCopy(v, w));
    for (Index l = 0; l < j; ++l)
      if (tableau_->a(j, l) != 0) check(VecAXPY(w, length_ * tableau_->a(j, l), k[at(l)].get()));
    if (!lift.empty()) check(VecAXPY(w, 1, lift[at(j)].get()));
    if (stage.frozen) {
      // H a(j,j) dF/dx w = A w - dF/d(dx/dt) w.
      const double own = length_ * tableau_->a(j, j);
      stage.frozen->multiply_rates(w, rhs);
      stage.frozen->multiply(w, k[at(j)].get());
      check(VecAXPY(rhs, -1, k[at(j)].get()));
      if (!load.empty()) check(VecAXPY(rhs, -own, load[at(j)].get()));
      stage.frozen->solve(rhs, k[at(j)].get(), product_tolerance);
      check(VecScale(k[at(j)].get(), 1 / own));
      continue;
    }
    check(MatMult(stage.jx.get(), w, rhs));
    if (!load.empty()) check(VecAXPY(rhs, 1, load[at(j)].get()));
    check(VecScale(rhs, -1));
    check(KSPSolve(stage.solver->get(), rhs, k[at(j)].get()));
  }
  for (Index j = 0; j < tableau_->stages(); ++j)
    if (tableau_->b(j) != 0) check(VecAXPY(out, length_ * tableau_->b(j), k[at(j)].get()));
}

void StepProduct::apply(Vec v) const {
  check(VecCopy(v, work_->start.get()));
  stages(work_->start.get(), {}, {}, v);
}

SparseRungeKutta::SparseRungeKutta(problem::System& system, Tableau tableau)
    : system_(system), tableau_(std::move(tableau)) {
  core::require(tableau_.sequential(), "steps distributed in space need a scheme with sequential stages");
  x_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  for (core::Vector* v : {&state_scale_, &residual_inverse_, &k_, &value_, &base_, &f_, &d_})
    *v = core::duplicate(x_.get());
  system.scales(state_scale_.get(), residual_inverse_.get());
  check(VecReciprocal(residual_inverse_.get()));
  work_ = std::make_shared<StepProduct::Work>();
  for (Index j = 0; j < tableau_.stages(); ++j) {
    slopes_.push_back(core::duplicate(x_.get()));
    work_->k.push_back(core::duplicate(x_.get()));
  }
  for (core::Vector* v : {&work_->start, &work_->w, &work_->rhs}) *v = core::duplicate(x_.get());
}

void SparseRungeKutta::fail() const {
  core::agree(system_.comm(), [] { throw core::DomainError("a stage of the Runge-Kutta step was not solved"); });
  std::abort();
}

void SparseRungeKutta::residual(double angle, Vec x, Vec k, Vec f) {
  check(VecPointwiseMult(x_.get(), x, state_scale_.get()));
  check(VecPointwiseMult(k_.get(), k, state_scale_.get()));
  system_.residual(angle, x_.get(), k_.get(), f);
  check(VecPointwiseMult(f, f, residual_inverse_.get()));
}

core::Matrix SparseRungeKutta::jacobian(double angle, Vec x, Vec k, double alpha, double sigma) {
  check(VecPointwiseMult(x_.get(), x, state_scale_.get()));
  check(VecPointwiseMult(k_.get(), k, state_scale_.get()));
  core::Matrix m = system_.make_jacobian();
  system_.jacobian(angle, x_.get(), k_.get(), alpha, sigma, m.get());
  check(MatDiagonalScale(m.get(), residual_inverse_.get(), state_scale_.get()));
  return m;
}

void SparseRungeKutta::factorise(core::Matrix matrix) {
  if (matrix_) {
    PetscBool same = PETSC_FALSE;
    check(MatEqual(matrix_->get(), matrix.get(), &same));
    if (same) return;
  }
  matrix_ = std::make_shared<const core::Matrix>(std::move(matrix));
  solver_ = make_solver(system_.comm(), matrix_->get());
}

std::shared_ptr<const problem::Frozen> SparseRungeKutta::freeze(double angle, Vec x, Vec k, double alpha) {
  check(VecPointwiseMult(x_.get(), x, state_scale_.get()));
  check(VecPointwiseMult(k_.get(), k, state_scale_.get()));
  return system_.freeze(angle, x_.get(), k_.get(), alpha, 1, frozen_.get());
}

// By chords: the equations stay frozen while every correction is at most a fifth of the last one.
bool SparseRungeKutta::solve_frozen_stage(double angle, double own, Vec base, Vec k) {
  double size = 0, correction = 0, last = 0;
  check(VecNorm(base, NORM_INFINITY, &size));
  std::shared_ptr<const problem::Frozen> frozen;
  for (int it = 0;; ++it) {
    check(VecWAXPY(value_.get(), own, k, base));
    residual(angle, value_.get(), k, f_.get());
    if (!frozen || (it > 1 && correction > 0.2 * last)) {
      frozen = freeze(angle, value_.get(), k, own);
      if (!frozen) return false;
      frozen_ = frozen;
    }
    frozen->solve(f_.get(), d_.get(), newton_tolerance);
    check(VecAXPY(k, -1, d_.get()));
    last = correction;
    check(VecNorm(d_.get(), NORM_INFINITY, &correction));
    if (!std::isfinite(correction)) fail();
    if (own * correction <= 1e-9 * (1 + size)) return true;
    if (it == 20) fail();
  }
}

// F(angle, base + own k, k) = 0.
void SparseRungeKutta::solve_stage(double angle, double own, Vec base, Vec k) {
  if (own != 0 && solve_frozen_stage(angle, own, base, k)) return;
  double size = 0, correction = 0;
  check(VecNorm(base, NORM_INFINITY, &size));
  for (int it = 0;; ++it) {
    check(VecWAXPY(value_.get(), own, k, base));
    residual(angle, value_.get(), k, f_.get());
    factorise(jacobian(angle, value_.get(), k, own, 1));
    check(KSPSolve(solver_->get(), f_.get(), d_.get()));
    check(VecAXPY(k, -1, d_.get()));
    check(VecNorm(d_.get(), NORM_INFINITY, &correction));
    if (!std::isfinite(correction)) fail();
    if (own == 0 || own * correction <= 1e-9 * (1 + size)) return;
    if (it == 20) fail();
  }
}

void SparseRungeKutta::rate(double angle, Vec x, Vec xdot) {
  check(VecSet(xdot, 0));
  solve_stage(angle, 0, x, xdot);
}

void SparseRungeKutta::step(double angle, double d_angle, double length, Vec x, StepProduct* product) {
  const Index s = tableau_.stages();
  std::vector<core::Vector> lifts, loads;
  core::Vector lift = core::duplicate(x);
  frozen_.reset();  // a new preconditioner for every step
  if (product) {
    product->tableau_ = &tableau_;
    product->length_ = length;
    product->work_ = work_;
    product->stages_.clear();
  }
  for (Index j = 0; j < s; ++j) {
    const double own = length * tableau_.a(j, j), here = angle + tableau_.c(j) * d_angle;
    Vec k = slopes_[at(j)].get();
    check(VecSet(lift.get(), 0));
    for (Index l = 0; l < j; ++l)
      if (tableau_.a(j, l) != 0) check(VecAXPY(lift.get(), tableau_.a(j, l), slopes_[at(l)].get()));
    check(VecWAXPY(base_.get(), length, lift.get(), x));
    if (j > 0)
      check(VecCopy(slopes_[at(j - 1)].get(), k));
    else
      check(VecSet(k, 0));
    solve_stage(here, own, base_.get(), k);
    if (!product) continue;
    check(VecWAXPY(value_.get(), own, k, base_.get()));
    StepProduct::Stage stage;
    if (own != 0) stage.frozen = freeze(here, value_.get(), k, own);
    if (!stage.frozen) {
      stage.jx = jacobian(here, value_.get(), k, 1, 0);
      factorise(jacobian(here, value_.get(), k, own, 1));
      stage.matrix = matrix_;
      stage.solver = solver_;
    }
    product->stages_.push_back(std::move(stage));
    check(VecAXPY(lift.get(), tableau_.a(j, j), k));
    lifts.push_back(core::duplicate(x));
    check(VecCopy(lift.get(), lifts.back().get()));
    loads.push_back(core::duplicate(x));
    check(VecPointwiseMult(x_.get(), value_.get(), state_scale_.get()));
    check(VecPointwiseMult(k_.get(), k, state_scale_.get()));
    system_.parameter_derivative(here, x_.get(), k_.get(), loads.back().get());
    check(VecPointwiseMult(loads.back().get(), loads.back().get(), residual_inverse_.get()));
  }
  core::Vector change = core::duplicate(x);
  check(VecSet(change.get(), 0));
  for (Index j = 0; j < s; ++j)
    if (tableau_.b(j) != 0) check(VecAXPY(change.get(), tableau_.b(j), slopes_[at(j)].get()));
  if (product) {
    core::Vector zero = core::duplicate(x);
    check(VecSet(zero.get(), 0));
    product->d_length_ = core::duplicate(x);
    check(VecCopy(change.get(), product->d_length_.get()));
    product->stages(zero.get(), lifts, {}, product->d_length_.get());
    product->d_parameter_ = core::duplicate(x);
    check(VecSet(product->d_parameter_.get(), 0));
    product->stages(zero.get(), {}, loads, product->d_parameter_.get());
  }
  check(VecAXPY(x, length, change.get()));
}

}  // namespace whirl::solve
