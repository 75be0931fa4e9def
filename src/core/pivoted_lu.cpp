#include "whirl/core/pivoted_lu.hpp"

#include <suitesparse/klu.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <vector>

namespace whirl::core {

using Eigen::Index;

namespace {

// The sign of a permutation.
int sign(const int* order, int n) {
  std::vector<bool> seen(static_cast<std::size_t>(n), false);
  int out = 1;
  for (int k = 0; k < n; ++k)
    for (int at = k; !seen[static_cast<std::size_t>(at)]; at = order[at]) {
      seen[static_cast<std::size_t>(at)] = true;
      if (order[at] != k) out = -out;
    }
  return out;
}

}  // namespace

template <class Scalar>
struct PivotedLu<Scalar>::Factors {
  static constexpr bool real = std::is_same_v<Scalar, double>;

  Factors() {
    klu_defaults(&common);
    common.tol = 0.1;  // of the largest entry a diagonal one has to be, to be the pivot
  }
  Factors(const Factors&) = delete;
  Factors& operator=(const Factors&) = delete;
  ~Factors() {
    forget();
    klu_free_symbolic(&symbolic, &common);
  }
  void forget() { (real ? klu_free_numeric : klu_z_free_numeric)(&numeric, &common); }

  int n = 0;
  mutable klu_common common{};  // calls write what became of them
  klu_symbolic* symbolic = nullptr;
  klu_numeric* numeric = nullptr;
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
  require(a.isCompressed() && a.rows() == a.cols(), "a square compressed matrix");
  Factors& f = *factors_;
  f.forget();
  klu_free_symbolic(&f.symbolic, &f.common);
  f.n = static_cast<int>(a.rows());
  f.symbolic = klu_analyze(f.n, const_cast<int*>(a.outerIndexPtr()), const_cast<int*>(a.innerIndexPtr()), &f.common);
}

template <class Scalar>
bool PivotedLu<Scalar>::factorise(const Matrix& a) {
  Factors& f = *factors_;
  f.forget();
  if (!f.symbolic) return false;  // there are too few entries for any values
  auto* const values = const_cast<double*>(reinterpret_cast<const double*>(a.valuePtr()));
  f.numeric = (Factors::real ? klu_factor : klu_z_factor)(
      const_cast<int*>(a.outerIndexPtr()), const_cast<int*>(a.innerIndexPtr()), values, f.symbolic, &f.common);
  if (f.common.status != KLU_OK) f.forget();
  return regular();
}

template <class Scalar>
bool PivotedLu<Scalar>::regular() const {
  return factors_->numeric != nullptr;
}

template <class Scalar>
Index PivotedLu<Scalar>::size() const {
  return factors_->n;
}

template <class Scalar>
Index PivotedLu<Scalar>::entries() const {
  return factors_->numeric ? factors_->numeric->lnz + factors_->numeric->unz : 0;
}

// P R^-1 A Q is triangular by blocks with U's diagonal, R positive.
template <class Scalar>
double PivotedLu<Scalar>::angle() const {
  const Factors& f = *factors_;
  const auto* const diagonal = static_cast<const Scalar*>(f.numeric->Udiag);
  double sum = sign(f.numeric->Pnum, f.n) * sign(f.symbolic->Q, f.n) > 0 ? 0 : std::numbers::pi;
  for (int k = 0; k < f.n; ++k) sum += std::arg(diagonal[k]);
  return sum;
}

template <class Scalar>
void PivotedLu<Scalar>::solve(const Scalar* y, Scalar* x, Index columns) const {
  const Factors& f = *factors_;
  std::copy_n(y, f.n * columns, x);
  (Factors::real ? klu_solve : klu_z_solve)(f.symbolic, f.numeric, f.n, static_cast<int>(columns),
                                            reinterpret_cast<double*>(x), &f.common);
}

template <class Scalar>
void PivotedLu<Scalar>::solve_transposed(const Scalar* y, Scalar* x, Index columns) const {
  const Factors& f = *factors_;
  std::copy_n(y, f.n * columns, x);
  auto* const values = reinterpret_cast<double*>(x);
  if constexpr (Factors::real)
    klu_tsolve(f.symbolic, f.numeric, f.n, static_cast<int>(columns), values, &f.common);
  else
    klu_z_tsolve(f.symbolic, f.numeric, f.n, static_cast<int>(columns), values, 0, &f.common);
}

template class PivotedLu<double>;
template class PivotedLu<std::complex<double>>;

}  // namespace whirl::core
