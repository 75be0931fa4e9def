#include "whirl/core/pivoted_lu.hpp"

#include <Eigen/SparseLU>
#include <cmath>
#include <numbers>

namespace whirl::core {

using Eigen::Dynamic;
using Eigen::Index;
using Eigen::Map;

template <class Scalar>
struct PivotedLu<Scalar>::Factors : Eigen::SparseLU<Matrix> {
  using Base = Eigen::SparseLU<Matrix>;
  [[nodiscard]] double angle() const {
    double sum = this->m_detPermR * this->m_detPermC > 0 ? 0 : std::numbers::pi;
    for (Index j = 0; j < this->cols(); ++j)
      for (typename Base::SCMatrix::InnerIterator e(this->m_Lstore, j); e; ++e)
        if (e.index() == j) {
          sum += std::arg(e.value());
          break;
        }
    return sum;
  }
};

template <class Scalar>
PivotedLu<Scalar>::PivotedLu() : factors_(std::make_unique<Factors>()) {}
template <class Scalar>
PivotedLu<Scalar>::PivotedLu(const Matrix& a) : PivotedLu() {
  compute(a);
}
template <class Scalar>
PivotedLu<Scalar>::PivotedLu(PivotedLu&&) noexcept = default;
template <class Scalar>
PivotedLu<Scalar>& PivotedLu<Scalar>::operator=(PivotedLu&&) noexcept = default;
template <class Scalar>
PivotedLu<Scalar>::~PivotedLu() = default;

template <class Scalar>
void PivotedLu<Scalar>::analyse(const Matrix& a) {
  factors_->analyzePattern(a);
}

template <class Scalar>
bool PivotedLu<Scalar>::factorise(const Matrix& a) {
  factors_->factorize(a);
  return regular();
}

template <class Scalar>
bool PivotedLu<Scalar>::regular() const {
  return factors_->info() == Eigen::Success;
}

template <class Scalar>
Index PivotedLu<Scalar>::size() const {
  return factors_->rows();
}

template <class Scalar>
Index PivotedLu<Scalar>::entries() const {
  return factors_->nnzL() + factors_->nnzU();
}

template <class Scalar>
double PivotedLu<Scalar>::angle() const {
  return factors_->angle();
}

template <class Scalar>
void PivotedLu<Scalar>::solve(const Scalar* y, Scalar* x, Index columns) const {
  using Vector = Eigen::Matrix<Scalar, Dynamic, 1>;
  using Columns = Eigen::Matrix<Scalar, Dynamic, Dynamic>;
  const Index n = size();
  if (columns == 1)
    Map<Vector>(x, n) = factors_->solve(Map<const Vector>(y, n));
  else
    Map<Columns>(x, n, columns) = factors_->solve(Map<const Columns>(y, n, columns));
}

template <class Scalar>
void PivotedLu<Scalar>::solve_transposed(const Scalar* y, Scalar* x, Index columns) const {
  using Columns = Eigen::Matrix<Scalar, Dynamic, Dynamic>;
  const Index n = size();
  Map<Columns>(x, n, columns) = factors_->transpose().solve(Map<const Columns>(y, n, columns));
}

template class PivotedLu<double>;
template class PivotedLu<std::complex<double>>;

}  // namespace whirl::core
