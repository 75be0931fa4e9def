#pragma once
// LU of sparse matrices with pivots, by KLU.

#include <Eigen/SparseCore>
#include <complex>
#include <memory>

#include "whirl/core/error.hpp"

namespace whirl::core {

/// KLU of SuiteSparse (Davis and Palamadai Natarajan 2010): blocks of a triangular form, columns ordered for few
/// entries (AMD), rows scaled and exchanged for a pivot of a tenth of the largest at least, the diagonal first. Scalar:
/// double or std::complex<double>. `SparseLu` is faster for films, whose matrices are real.
template <class Scalar>
class PivotedLu {
public:
  using Matrix = Eigen::SparseMatrix<Scalar>;

  PivotedLu();
  explicit PivotedLu(const Matrix& a);
  PivotedLu(PivotedLu&&) noexcept;
  PivotedLu& operator=(PivotedLu&&) noexcept;
  ~PivotedLu();

  /// The order of the columns, for all matrices with the entries of `a`.
  void analyse(const Matrix& a);
  /// False if A is singular; nothing can be solved then.
  bool factorise(const Matrix& a);
  bool compute(const Matrix& a) {
    analyse(a);
    return factorise(a);
  }
  [[nodiscard]] bool regular() const;
  [[nodiscard]] Eigen::Index size() const;
  /// Of both factors.
  [[nodiscard]] Eigen::Index entries() const;
  /// The angle of det A [rad] but for whole turns: the determinant itself may overflow.
  [[nodiscard]] double angle() const;

  /// A^-1 y and A^-T y (not conjugated) of a vector or of all columns.
  template <class Y>
  [[nodiscard]] typename Y::PlainObject solve(const Eigen::MatrixBase<Y>& y) const {
    return answer(&PivotedLu::solve, y.derived().eval());
  }
  template <class Y>
  [[nodiscard]] typename Y::PlainObject solve_transposed(const Eigen::MatrixBase<Y>& y) const {
    return answer(&PivotedLu::solve_transposed, y.derived().eval());
  }
  /// x = A^-1 y and A^-T y of n x columns numbers each, which do not overlap.
  void solve(const Scalar* y, Scalar* x, Eigen::Index columns) const;
  void solve_transposed(const Scalar* y, Scalar* x, Eigen::Index columns) const;

private:
  template <class Plain>
  [[nodiscard]] Plain answer(void (PivotedLu::*by)(const Scalar*, Scalar*, Eigen::Index) const, const Plain& y) const {
    static_assert(!Plain::IsRowMajor, "columns one behind the other");
    require(y.rows() == size(), "right-hand sides of the size of the matrix");
    Plain x(y.rows(), y.cols());
    (this->*by)(y.data(), x.data(), y.cols());
    return x;
  }
  struct Factors;
  std::unique_ptr<Factors> factors_;
};

extern template class PivotedLu<double>;
extern template class PivotedLu<std::complex<double>>;

}  // namespace whirl::core
