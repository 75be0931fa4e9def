// Stages of a system that may be distributed in space.

#include <Eigen/SparseCore>
#include <algorithm>
#include <functional>
#include <vector>

#include "solve/newton/local_part.hpp"
#include "solve/newton/port_krylov.hpp"
#include "solve/newton/port_maker.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/index.hpp"
#include "whirl/core/matrix_rows.hpp"
#include "whirl/problem/spread_point.hpp"
#include "whirl/solve/shooting/runge_kutta.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

// Relative residuals of explicit stages, of corrections, and of slopes.
constexpr double explicit_tolerance = 1e-13, correction_tolerance = 1e-5, slope_tolerance = 1e-9;

// Up to this many states the making of a solver of PETSc takes longer than all of the arithmetic.
constexpr PetscInt small = 64;

// A matrix ready to solve with.
struct Inverse {
  // y := matrix^-1 y [local x columns], to a relative residual where it iterates, else to rounding.
  std::function<void(Ref<MatrixXd> y, double tolerance)> solve;
  std::shared_ptr<const PortMatrix> blocks{};  // the matrix if its parts are eliminated,
  mutable core::Matrix whole{};                // or if MUMPS factorises it
};
using SharedInverse = std::shared_ptr<const Inverse>;

// Of a matrix with one entry in each row and column, on their own rank: masses beside rates q'. Null of others.
SharedInverse entry_by_entry(MPI_Comm comm, Mat matrix) {
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(matrix, &begin, &end));
  VectorXd inverse = VectorXd::Zero(end - begin);
  Eigen::VectorX<PetscInt> column = Eigen::VectorX<PetscInt>::Constant(end - begin, -1);
  std::vector<bool> taken(core::at(end - begin), false);
  int single = 1;
  core::for_rows(matrix, [&](PetscInt row, const PetscInt* columns, const PetscScalar* values, PetscInt count) {
    for (PetscInt k = 0; k < count; ++k) {
      if (values[k] == 0) continue;
      const PetscInt c = columns[k] - begin;
      if (c < 0 || c >= end - begin || column(row) >= 0 || taken[core::at(c)]) {
        single = 0;
        continue;
      }
      taken[core::at(c)] = true;
      column(row) = c;
      inverse(row) = 1 / values[k];
    }
    if (column(row) < 0) single = 0;
  });
  MPI_Allreduce(MPI_IN_PLACE, &single, 1, MPI_INT, MPI_MIN, comm);
  if (single == 0) return nullptr;
  return std::make_shared<Inverse>(Inverse{[inverse, column](Ref<MatrixXd> y, double) {
    const MatrixXd scaled = inverse.asDiagonal() * y;
    for (Index i = 0; i < y.rows(); ++i) y.row(column(i)) = scaled.row(i);
  }});
}

// Solves to rounding, so that products are exact: factorised on every rank, with one step of refinement for what LU
// without pivoting loses. No reductions, which cost more than the arithmetic of a machine without parts.
core::LinearSolver redundant_lu(MPI_Comm comm, Mat matrix) {
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

class SparseStages final : public Stages {
public:
  SparseStages(problem::System& system, bool constant_rates, bool whole)
      : system_(system),
        constant_rates_(constant_rates),
        whole_(whole),
        point_(system),
        maker_(whole ? nullptr : PortMaker::make(system)) {
    for (core::Vector* v : {&x_, &k_, &f_}) *v = core::duplicate(point_.state_scale());
  }
  std::unique_ptr<Stage> make() override;
  [[nodiscard]] MPI_Comm comm() const override { return system_.comm(); }
  void refresh() override {
    rates_.reset();
    rate_blocks_.reset();
  }
  /// The next matrix of parts is eliminated anew.
  void begin_step() override { similar_.reset(); }
  [[nodiscard]] bool by_chords() const override { return true; }
  /// The parts' own inverses may serve in this step: corrections are dear then.
  [[nodiscard]] double tolerance() const override { return similar_ && similar_->inverse() ? 1e-9 : 1e-11; }

private:
  friend class SparseStage;
  // dF/d(dx/dt) + own dF/dx at x_ and k_.
  [[nodiscard]] SharedInverse inverse(double angle, double own, const SharedInverse& before) {
    if (before && before->whole) {
      ++factorisations_;
      point_.jacobian(angle, x_.get(), k_.get(), own, 1, before->whole);
      return before;
    }
    if (own != 0 && maker_) {
      point_.jacobian(angle, x_.get(), k_.get(), own, 1, scratch_);
      return by_parts(scratch_.get(), angle, own);
    }
    if (own == 0 && rates_) return rates_;
    core::Matrix matrix;
    point_.jacobian(angle, x_.get(), k_.get(), own, 1, matrix);
    SharedInverse out = entry_by_entry(comm(), matrix.get());
    if (!out) out = maker_ ? by_parts(matrix.get(), angle, own) : by_lu(std::move(matrix));
    if (own == 0 && constant_rates_) rates_ = out;
    return out;
  }
  // dF/d(dx/dt) there, in blocks.
  [[nodiscard]] std::shared_ptr<const PortMatrix> rate_blocks(double angle) {
    if (rate_blocks_) return rate_blocks_;
    point_.jacobian(angle, x_.get(), k_.get(), 0, 1, scratch_);
    auto out = maker_->blocks(scratch_.get());
    if (constant_rates_) rate_blocks_ = out;
    return out;
  }

  // FGMRES, with the elimination of the parts in the first matrix of a step as the preconditioner of all others.
  [[nodiscard]] SharedInverse by_parts(Mat a, double angle, double own) {
    const auto blocks = maker_->blocks(a);
    if (!krylov_) krylov_ = std::make_unique<PortKrylov>(*maker_->layout(), "stage_");
    std::shared_ptr<PortElimination> by = own != 0 ? similar_ : nullptr;
    if (!by) {
      ++factorisations_;
      by = maker_->eliminate(*blocks, angle, point_.x(), point_.xdot(), own);
    }
    if (own != 0) similar_ = by;
    return std::make_shared<Inverse>(
        Inverse{[this, blocks, by](Ref<MatrixXd> y, double tolerance) {
                  by_columns(y, [&](Vec b, Vec x) { (void)krylov_->solve(*blocks, *by, b, x, tolerance); });
                },
                blocks});
  }

  // By MUMPS, or on every rank; dense if it is small and on one rank.
  [[nodiscard]] SharedInverse by_lu(core::Matrix matrix) {
    ++factorisations_;
    if (core::size_of(comm()) == 1 && system_.size() <= small) {
      const core::DenseLu<double> lu(core::dense(matrix.get()));
      return std::make_shared<Inverse>(Inverse{[lu](Ref<MatrixXd> y, double) { y = lu.solve(y); }});
    }
    const auto solver = std::make_shared<core::LinearSolver>(whole_ ? core::make_direct_solver(comm(), "stage_")
                                                                    : redundant_lu(comm(), matrix.get()));
    if (whole_) check(KSPSetOperators(solver->get(), matrix.get(), matrix.get()));
    const auto act = [this, solver](Ref<MatrixXd> y, double) {
      by_columns(y, [&](Vec b, Vec x) { check(KSPSolve(solver->get(), b, x)); });
    };
    return std::make_shared<Inverse>(Inverse{act, {}, whole_ ? std::move(matrix) : core::Matrix()});
  }

  // y := what act(b, x) makes x of b = y, column by column.
  template <class Act>
  void by_columns(Ref<MatrixXd> y, const Act& act) const {
    for (Index c = 0; c < y.cols(); ++c) {
      put(y.col(c), f_.get());
      act(f_.get(), x_.get());
      y.col(c) = get(x_.get());
    }
  }

  problem::System& system_;
  bool constant_rates_, whole_;
  problem::SpreadPoint point_;
  core::Vector x_, k_, f_;            // work space of the stages,
  core::Matrix scratch_;              // and a matrix: making one costs more than filling a small one
  std::unique_ptr<PortMaker> maker_;  // of a system that has parts
  std::unique_ptr<PortKrylov> krylov_;
  std::shared_ptr<PortElimination> similar_;
  SharedInverse rates_;                            // of explicit stages with constant rates
  std::shared_ptr<const PortMatrix> rate_blocks_;  // dF/d(dx/dt) if it is constant
};

class SparseStage final : public Stage {
public:
  explicit SparseStage(SparseStages& all) : all_(all) {}

  void residual(const StageGroup& group, In x, In k, Out f, bool) override {
    put(x.col(0), all_.x_.get());
    put(k.col(0), all_.k_.get());
    all_.point_.residual(group.angle(0), all_.x_.get(), all_.k_.get(), all_.f_.get());
    f = get(all_.f_.get());
  }

  void factorise(const StageGroup& group, In, In) override {
    own_ = group.own(0, 0);
    inverse_ = all_.inverse(group.angle(0), own_, inverse_);
  }

  void solve(Out f, double tolerance) override {
    inverse_->solve(f, own_ == 0 ? explicit_tolerance : std::min(tolerance, correction_tolerance));
  }

  void keep(const StageGroup& group, In x, In k) override {
    const double angle = group.angle(0);
    put(x.col(0), all_.x_.get());
    put(k.col(0), all_.k_.get());
    if (!inverse_ || group.own(0, 0) != 0) factorise(group, x, k);
    rates_.reset();
    if (inverse_->blocks && own_ != 0) {
      rates_ = all_.rate_blocks(angle);
    } else if (core::size_of(all_.comm()) > 1) {
      all_.point_.jacobian(angle, all_.x_.get(), all_.k_.get(), 1, 0, jx_);
    } else {
      all_.point_.jacobian(angle, all_.x_.get(), all_.k_.get(), 1, 0, all_.scratch_);
      sparse_.resize(x.rows(), x.rows());
      core::for_rows(all_.scratch_.get(),
                     [&](PetscInt row, const PetscInt* columns, const double* values, PetscInt count) {
                       sparse_.startVec(row);
                       for (PetscInt c = 0; c < count; ++c)
                         if (values[c] != 0) sparse_.insertBack(row, columns[c]) = values[c];
                     });
      sparse_.finalize();
    }
    all_.point_.parameter_derivative(angle, all_.x_.get(), all_.k_.get(), all_.f_.get());
    load_ = get(all_.f_.get());
  }

  void slopes(In w, bool loaded, Out dk) override {
    if (rates_) {
      // own dF/dx w = A w - dF/d(dx/dt) w
      VectorXd moved(w.rows()), by_rates(w.rows());
      for (Index c = 0; c < w.cols(); ++c) {
        inverse_->blocks->multiply(w.col(c).data(), moved.data());
        rates_->multiply(w.col(c).data(), by_rates.data());
        dk.col(c) = (by_rates - moved) / own_;
      }
    } else if (jx_) {
      dk = -w;
      all_.by_columns(dk, [&](Vec v, Vec product) { check(MatMult(jx_.get(), v, product)); });
    } else {
      dk = -(sparse_ * w);
    }
    if (loaded) dk.rightCols(1) -= load_;
    inverse_->solve(dk, slope_tolerance);
  }

private:
  SparseStages& all_;
  double own_ = 0;
  SharedInverse inverse_;
  std::shared_ptr<const PortMatrix> rates_;  // in blocks, or dF/dx
  core::Matrix jx_;                          // on several ranks,
  Sparse sparse_;                            // on one
  VectorXd load_;                            // dF/dp
};

std::unique_ptr<Stage> SparseStages::make() {
  return std::make_unique<SparseStage>(*this);
}

}  // namespace

std::unique_ptr<Stages> sparse_stages(problem::System& system, bool constant_rates, bool whole) {
  return std::make_unique<SparseStages>(system, constant_rates, whole);
}

}  // namespace whirl::solve
