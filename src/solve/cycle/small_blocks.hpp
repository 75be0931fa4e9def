#pragma once
// Kernels on m x m blocks, column by column in memory, with m known to the compiler as M, or M = 0. Outputs do not
// overlap inputs.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace whirl::solve {

// y += sign a x for x, y [m x columns].
template <int M>
void accumulate(Eigen::Index degree, const double* __restrict a, const double* __restrict x, Eigen::Index columns,
                double* __restrict y, double sign) {
  if constexpr (M > 0) {
    for (Eigen::Index c = 0; c < columns; ++c) {
      double sum[M];
      for (Eigen::Index l = 0; l < M; ++l) sum[l] = y[c * M + l];
      for (Eigen::Index q = 0; q < M; ++q) {
        const double v = sign * x[c * M + q];
        for (Eigen::Index l = 0; l < M; ++l) sum[l] += a[q * M + l] * v;
      }
      for (Eigen::Index l = 0; l < M; ++l) y[c * M + l] = sum[l];
    }
  } else {
    const Eigen::Index m = degree;
    for (Eigen::Index c = 0; c < columns; ++c)
      for (Eigen::Index q = 0; q < m; ++q)
        for (Eigen::Index l = 0; l < m; ++l) y[c * m + l] += a[q * m + l] * sign * x[c * m + q];
  }
}
template <int M>
void subtract(Eigen::Index degree, const double* a, const double* x, Eigen::Index columns, double* y) {
  accumulate<M>(degree, a, x, columns, y, -1);
}
template <int M>
void multiply_by(Eigen::Index degree, const double* a, const double* x, Eigen::Index columns, double* y) {
  std::fill(y, y + degree * columns, 0.0);
  accumulate<M>(degree, a, x, columns, y, 1);
}

// y += a x for a [m x count], x [count] and one column y [m].
template <int M>
void accumulate_column(Eigen::Index degree, const double* __restrict a, const double* __restrict x, Eigen::Index count,
                       double* __restrict y) {
  if constexpr (M > 0) {
    double even[M], odd[M];
    for (Eigen::Index l = 0; l < M; ++l) even[l] = y[l], odd[l] = 0;
    Eigen::Index e = 0;
    for (; e + 1 < count; e += 2)  // two sums at once hide the latency of each
      for (Eigen::Index l = 0; l < M; ++l) {
        even[l] += a[e * M + l] * x[e];
        odd[l] += a[(e + 1) * M + l] * x[e + 1];
      }
    for (; e < count; ++e)
      for (Eigen::Index l = 0; l < M; ++l) even[l] += a[e * M + l] * x[e];
    for (Eigen::Index l = 0; l < M; ++l) y[l] = even[l] + odd[l];
  } else {
    for (Eigen::Index e = 0; e < count; ++e)
      for (Eigen::Index l = 0; l < degree; ++l) y[l] += a[e * degree + l] * x[e];
  }
}

// y -= a^T x, one column.
template <int M>
void subtract_transposed(Eigen::Index degree, const double* a, const double* x, double* y) {
  const Eigen::Index m = M > 0 ? M : degree;
  for (Eigen::Index q = 0; q < m; ++q)
    for (Eigen::Index l = 0; l < m; ++l) y[q] -= a[q * m + l] * x[l];
}

// out = a^-1 by Gauss-Jordan elimination with row exchanges; `a` is used up.
template <int M>
void invert(Eigen::Index degree, double* a, double* out) {
  const Eigen::Index m = M > 0 ? M : degree;
  std::fill(out, out + m * m, 0.0);
  for (Eigen::Index k = 0; k < m; ++k) out[k * m + k] = 1;
  for (Eigen::Index k = 0; k < m; ++k) {
    Eigen::Index pivot = k;
    for (Eigen::Index l = k + 1; l < m; ++l)
      if (std::abs(a[k * m + l]) > std::abs(a[k * m + pivot])) pivot = l;
    const double scale = 1 / a[k * m + pivot];
    for (Eigen::Index c = 0; c < m; ++c) {
      std::swap(a[c * m + k], a[c * m + pivot]);
      std::swap(out[c * m + k], out[c * m + pivot]);
      a[c * m + k] *= scale;
      out[c * m + k] *= scale;
    }
    for (Eigen::Index l = 0; l < m; ++l) {
      if (l == k) continue;
      const double v = a[k * m + l];
      for (Eigen::Index c = 0; c < m; ++c) {
        a[c * m + l] -= v * a[c * m + k];
        out[c * m + l] -= v * out[c * m + k];
      }
    }
  }
}

}  // namespace whirl::solve
