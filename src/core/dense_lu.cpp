#include "whirl/core/dense_lu.hpp"

namespace whirl::core {

using Eigen::Dynamic;
using Eigen::Map;

template <class Scalar>
void DenseLu<Scalar>::compute(const Matrix& a) {
  lu_.compute(a);
}

template <class Scalar>
void DenseLu<Scalar>::apply(const Scalar* y, Scalar* x, Eigen::Index columns) const {
  using Vector = Eigen::Matrix<Scalar, Dynamic, 1>;
  const Eigen::Index n = size();
  if (columns == 1)
    Map<Vector>(x, n) = lu_.solve(Map<const Vector>(y, n));
  else
    Map<Matrix>(x, n, columns) = lu_.solve(Map<const Matrix>(y, n, columns));
}

template <class Scalar>
void DenseLu<Scalar>::apply_transposed(const Scalar* y, Scalar* x, Eigen::Index columns) const {
  using Vector = Eigen::Matrix<Scalar, Dynamic, 1>;
  const Eigen::Index n = size();
  if (columns == 1)
    Map<Vector>(x, n) = lu_.transpose().solve(Map<const Vector>(y, n));
  else
    Map<Matrix>(x, n, columns) = lu_.transpose().solve(Map<const Matrix>(y, n, columns));
}

template <class Scalar>
typename DenseLu<Scalar>::Matrix DenseLu<Scalar>::inverse() const {
  return lu_.inverse();
}

template <class Scalar>
double DenseLu<Scalar>::rcond() const {
  if ((lu_.matrixLU().diagonal().array() == Scalar(0)).any()) return 0;  // Eigen's estimate leaves such rows out
  return lu_.rcond();
}

template class DenseLu<double>;
template class DenseLu<std::complex<double>>;

}  // namespace whirl::core
