#include "transient/state_factors.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::transient {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double digits_kept = 1e-8;  // of |S x - y|/|y|; what is left goes by the refinement of who solves

}  // namespace

void StateFactors::set_pattern(const ByRows& rows) {
  const auto n = static_cast<PetscInt>(rows.rows());
  rows_ = rows;
  // Sorted rows: values go in as they stand.
  check(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 0, nullptr, matrix_.put()));
  check(MatSeqAIJSetPreallocationCSR(matrix_.get(), rows_.outerIndexPtr(), rows_.innerIndexPtr(), rows_.valuePtr()));
  factors_.reset();
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, nullptr, from_.put()));
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, nullptr, to_.put()));
}

bool StateFactors::without_pivots(const Matrix& s) {
  ByRows rows = s;
  rows.makeCompressed();
  const auto same = [&] {
    return rows.rows() == rows_.rows() && rows.nonZeros() == rows_.nonZeros() &&
           std::equal(rows.outerIndexPtr(), rows.outerIndexPtr() + rows.rows(), rows_.outerIndexPtr()) &&
           std::equal(rows.innerIndexPtr(), rows.innerIndexPtr() + rows.nonZeros(), rows_.innerIndexPtr());
  };
  if (!matrix_ || !same()) {
    set_pattern(rows);
  } else {
    PetscScalar* values = nullptr;
    check(MatSeqAIJGetArrayWrite(matrix_.get(), &values));
    std::copy_n(rows.valuePtr(), rows.nonZeros(), values);
    check(MatSeqAIJRestoreArrayWrite(matrix_.get(), &values));
  }
  PetscBool missing = PETSC_FALSE;  // an entry of the diagonal
  check(MatMissingDiagonal(matrix_.get(), &missing, nullptr));
  if (missing) return false;
  MatFactorInfo info;
  check(MatFactorInfoInitialize(&info));
  if (!factors_) {
    core::IndexSet by_row, by_column;
    check(MatGetOrdering(matrix_.get(), MATORDERINGND, by_row.put(), by_column.put()));
    check(MatGetFactor(matrix_.get(), MATSOLVERPETSC, MAT_FACTOR_LU, factors_.put()));
    check(MatLUFactorSymbolic(factors_.get(), matrix_.get(), by_row.get(), by_column.get(), &info));
  }
  check(MatLUFactorNumeric(factors_.get(), matrix_.get(), &info));
  MatFactorError failure = MAT_FACTOR_NOERROR;
  check(MatFactorGetError(factors_.get(), &failure));
  if (failure != MAT_FACTOR_NOERROR) return false;
  work_.resize(s.rows());
  for (Index i = 0; i < work_.size(); ++i) work_(i) = 1 + 0.5 * std::sin(static_cast<double>(i));
  VectorXd x(work_.size());
  solve(work_.data(), x.data());
  return x.allFinite() && (s * x - work_).norm() <= digits_kept * work_.norm();
}

void StateFactors::compute(const Matrix& s) {
  if (!pivoted_) {
    if (without_pivots(s)) return;
    pivoted_ = std::make_unique<Eigen::SparseLU<Matrix, Eigen::COLAMDOrdering<int>>>();
    matrix_.reset();
    factors_.reset();
  }
  pivoted_->compute(s);
  if (pivoted_->info() != Eigen::Success) throw core::NotConverged("the matrix of a film's states is singular");
}

void StateFactors::solve(const double* y, double* x) const {
  if (pivoted_) {
    const Index n = pivoted_->rows();
    Eigen::Map<VectorXd>(x, n) = pivoted_->solve(Eigen::Map<const VectorXd>(y, n));
    return;
  }
  check(VecPlaceArray(from_.get(), y));
  check(VecPlaceArray(to_.get(), x));
  check(MatSolve(factors_.get(), from_.get(), to_.get()));
  check(VecResetArray(to_.get()));
  check(VecResetArray(from_.get()));
}

MatrixXd StateFactors::solve(const MatrixXd& y) const {
  MatrixXd x(y.rows(), y.cols());
  for (Index k = 0; k < y.cols(); ++k) solve(y.col(k).data(), x.col(k).data());
  return x;
}

}  // namespace whirl::transient
