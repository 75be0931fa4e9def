#pragma once
// LU of dense matrices, compiled once: Eigen's takes seconds of compiling in each file that solves with it.

#include <Eigen/LU>
#include <complex>

#include "whirl/core/error.hpp"

namespace whirl::core {

/// P A = L U of a square matrix, rows exchanged for the largest pivot (Eigen::PartialPivLU). Scalar: double or
/// std::complex<double>. The answers of a singular matrix mean nothing; rcond() tells of one.
template <class Scalar>
class DenseLu {
public:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  DenseLu() = default;
  explicit DenseLu(const Matrix& a) { compute(a); }

  void compute(const Matrix& a);
  [[nodiscard]] Eigen::Index size() const { return lu_.rows(); }
  /// A^-1 y and A^-T y (not conjugated) of a vector or of all columns.
  template <class Y>
  [[nodiscard]] typename Y::PlainObject solve(const Eigen::MatrixBase<Y>& y) const {
    return answer(&DenseLu::apply, y.derived().eval());
  }
  template <class Y>
  [[nodiscard]] typename Y::PlainObject solve_transposed(const Eigen::MatrixBase<Y>& y) const {
    return answer(&DenseLu::apply_transposed, y.derived().eval());
  }
  [[nodiscard]] Matrix inverse() const;
  /// Estimate of 1/(|A| |A^-1|).
  [[nodiscard]] double rcond() const;

private:
  // x = A^-1 y of n x columns numbers each, which do not overlap.
  void apply(const Scalar* y, Scalar* x, Eigen::Index columns) const;
  void apply_transposed(const Scalar* y, Scalar* x, Eigen::Index columns) const;
  template <class Plain>
  [[nodiscard]] Plain answer(void (DenseLu::*by)(const Scalar*, Scalar*, Eigen::Index) const, const Plain& y) const {
    static_assert(!Plain::IsRowMajor, "columns one behind the other");
    require(y.rows() == size(), "right-hand sides of the size of the matrix");
    Plain x(y.rows(), y.cols());
    (this->*by)(y.data(), x.data(), y.cols());
    return x;
  }

  Eigen::PartialPivLU<Matrix> lu_;
};

extern template class DenseLu<double>;
extern template class DenseLu<std::complex<double>>;

}  // namespace whirl::core
