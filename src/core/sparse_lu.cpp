#include "whirl/core/sparse_lu.hpp"

#include <algorithm>
#include <cmath>

namespace whirl::core {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double digits_lost = 1e-12;

}  // namespace

void SparseLu::set_pattern(const ByRows& rows) {
  const auto n = static_cast<PetscInt>(rows.rows());
  rows_ = rows;
  check(MatCreateSeqAIJ(PETSC_COMM_SELF, n, n, 0, nullptr, matrix_.put()));
  check(MatSeqAIJSetPreallocationCSR(matrix_.get(), rows_.outerIndexPtr(), rows_.innerIndexPtr(), rows_.valuePtr()));
  factors_.reset();
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, nullptr, from_.put()));
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, nullptr, to_.put()));
}

bool SparseLu::without_pivots(const Matrix& a) {
  ByRows rows = a;
  rows.makeCompressed();
  const auto same = [&] {
    return rows.rows() == rows_.rows() && rows.nonZeros() == rows_.nonZeros() &&
           std::equal(rows.outerIndexPtr(), rows.outerIndexPtr() + rows.rows(), rows_.outerIndexPtr()) &&
           std::equal(rows.innerIndexPtr(), rows.innerIndexPtr() + rows.nonZeros(), rows_.innerIndexPtr());
  };
  if (!matrix_ || !same()) {
    set_pattern(rows);
  } else {
    // Rows are sorted in both.
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
  info.fill = 10;  // entries expected of those of A: the symbolic part allocates once
  if (!factors_) {
    IndexSet by_row, by_column;
    check(MatGetOrdering(matrix_.get(), MATORDERINGND, by_row.put(), by_column.put()));
    check(MatGetFactor(matrix_.get(), MATSOLVERPETSC, MAT_FACTOR_LU, factors_.put()));
    check(MatLUFactorSymbolic(factors_.get(), matrix_.get(), by_row.get(), by_column.get(), &info));
  }
  check(MatLUFactorNumeric(factors_.get(), matrix_.get(), &info));
  MatFactorError failure = MAT_FACTOR_NOERROR;
  check(MatFactorGetError(factors_.get(), &failure));
  if (failure != MAT_FACTOR_NOERROR) return false;
  VectorXd y(a.rows()), x(a.rows());
  for (Index i = 0; i < y.size(); ++i) y(i) = 1 + 0.5 * std::sin(static_cast<double>(i));
  solve(y.data(), x.data());
  if (!x.allFinite()) return false;
  // What is left of each row, of the terms that it is the sum of (Oettli and Prager 1964).
  const VectorXd left = (a * x - y).cwiseAbs(), terms = a.cwiseAbs() * x.cwiseAbs() + y.cwiseAbs();
  return (left.array() <= digits_lost * terms.array()).all();
}

bool SparseLu::compute(const Matrix& a) {
  if (!pivoted_) {
    if (without_pivots(a)) return true;
    pivoted_.emplace();
    matrix_.reset();
    factors_.reset();
  }
  return pivoted_->compute(a);
}

void SparseLu::apply(PetscErrorCode (*by)(Mat, Vec, Vec), const double* y, double* x) const {
  check(VecPlaceArray(from_.get(), y));
  check(VecPlaceArray(to_.get(), x));
  check(by(factors_.get(), from_.get(), to_.get()));
  check(VecResetArray(to_.get()));
  check(VecResetArray(from_.get()));
}

void SparseLu::solve(const double* y, double* x) const {
  if (pivoted_) return pivoted_->solve(y, x, 1);
  apply(MatSolve, y, x);
}

MatrixXd SparseLu::solve(const MatrixXd& y) const {
  MatrixXd x(y.rows(), y.cols());
  for (Index k = 0; k < y.cols(); ++k) solve(y.col(k).data(), x.col(k).data());
  return x;
}

MatrixXd SparseLu::solve_transposed(const MatrixXd& y) const {
  if (pivoted_) return pivoted_->solve_transposed(y);
  MatrixXd x(y.rows(), y.cols());
  for (Index k = 0; k < y.cols(); ++k) apply(MatSolveTranspose, y.col(k).data(), x.col(k).data());
  return x;
}

}  // namespace whirl::core
