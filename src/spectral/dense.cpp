#include "whirl/spectral/dense.hpp"

#include <algorithm>
#include <complex>
#include <limits>
#include <numeric>
#include <vector>

#include "whirl/core/lapack.hpp"

extern "C" {
void zgesdd_(const char* job, const int* m, const int* n, std::complex<double>* a, const int* lda, double* s,
             std::complex<double>* u, const int* ldu, std::complex<double>* vt, const int* ldvt,
             std::complex<double>* work, const int* lwork, double* rwork, int* iwork, int* info);
void dgesdd_(const char* job, const int* m, const int* n, double* a, const int* lda, double* s, double* u,
             const int* ldu, double* vt, const int* ldvt, double* work, const int* lwork, int* iwork, int* info);
void dgeev_(const char* left, const char* right, const int* n, double* a, const int* lda, double* re, double* im,
            double* vl, const int* ldvl, double* vr, const int* ldvr, double* work, const int* lwork, int* info);
void zgeev_(const char* left, const char* right, const int* n, std::complex<double>* a, const int* lda,
            std::complex<double>* w, std::complex<double>* vl, const int* ldvl, std::complex<double>* vr,
            const int* ldvr, std::complex<double>* work, const int* lwork, double* rwork, int* info);
}

namespace whirl::spectral {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

// Calls a routine of LAPACK; false if it has no answer.
template <class Number, class Call>
bool answers(const Call& call) {
  return core::with_workspace<Number>(call) == 0;
}

// `job` is S for thin factors, A for whole ones, N for none; V* is returned in `vt`.
VectorXd decompose(char job, MatrixXcd& a, MatrixXcd& u, MatrixXcd& vt) {
  const int m = static_cast<int>(a.rows()), n = static_cast<int>(a.cols()), least = std::min(m, n),
            most = std::max(m, n);
  VectorXd sizes(least);
  if (least == 0) return sizes;
  if (job != 'N') u.resize(m, job == 'A' ? m : least), vt.resize(job == 'A' ? n : least, n);
  const int ldu = std::max<int>(1, static_cast<int>(u.rows())), ldvt = std::max<int>(1, static_cast<int>(vt.rows()));
  std::vector<double> real(static_cast<std::size_t>(least) * (5 * least + 2 * most + 7));
  std::vector<int> integer(static_cast<std::size_t>(8 * least));
  const bool found = a.allFinite() && answers<Complex>([&](Complex* work, const int* size, int* info) {
                       zgesdd_(&job, &m, &n, a.data(), &m, sizes.data(), u.data(), &ldu, vt.data(), &ldvt, work, size,
                               real.data(), integer.data(), info);
                     });
  if (!found) sizes.setConstant(nothing), u.setConstant(nothing), vt.setConstant(nothing);
  return sizes;
}

}  // namespace

Svd svd(MatrixXcd a) {
  Svd out;
  MatrixXcd vt;
  out.sizes = decompose('S', a, out.u, vt);
  out.v = vt.adjoint();
  return out;
}

VectorXd singular_values(MatrixXcd a) {
  MatrixXcd none, neither;
  return decompose('N', a, none, neither);
}

VectorXd singular_values(MatrixXd a) {
  const int m = static_cast<int>(a.rows()), n = static_cast<int>(a.cols()), least = std::min(m, n), one = 1;
  VectorXd sizes(least);
  if (least == 0) return sizes;
  std::vector<int> integer(static_cast<std::size_t>(8 * least));
  const bool found = a.allFinite() && answers<double>([&](double* work, const int* size, int* info) {
                       dgesdd_("N", &m, &n, a.data(), &m, sizes.data(), nullptr, &one, nullptr, &one, work, size,
                               integer.data(), info);
                     });
  if (!found) sizes.setConstant(nothing);
  return sizes;
}

Eigen::VectorXcd least_direction(MatrixXcd a) {
  MatrixXcd u, vt;
  (void)decompose(a.rows() < a.cols() ? 'A' : 'S', a, u, vt);
  return vt.bottomRows(1).adjoint();
}

Eigenpairs real_eigenpairs(MatrixXd a, bool vectors) {
  const int n = static_cast<int>(a.rows()), ldv = vectors ? std::max(1, n) : 1;
  const Index columns = vectors ? n : 0;
  Eigenpairs out{Eigen::VectorXcd(n), MatrixXcd(columns, columns)};
  if (n == 0) return out;
  VectorXd re(n), im(n);
  MatrixXd v(columns, columns);
  const bool found = a.allFinite() && answers<double>([&](double* work, const int* size, int* info) {
                       dgeev_("N", vectors ? "V" : "N", &n, a.data(), &n, re.data(), im.data(), nullptr, &ldv, v.data(),
                              &ldv, work, size, info);
                     });
  if (!found) re.setConstant(nothing);
  for (Index k = 0; k < n; ++k) out.values(k) = Complex(re(k), im(k));
  for (Index k = 0; k < columns; ++k) {
    // The real and the imaginary part of a pair's first vector stand side by side.
    if (im(k) == 0 || !found) {
      out.vectors.col(k) = v.col(k).cast<Complex>();
      continue;
    }
    for (Index r = 0; r < n; ++r) {
      out.vectors(r, k) = Complex(v(r, k), v(r, k + 1));
      out.vectors(r, k + 1) = std::conj(out.vectors(r, k));
    }
    ++k;
  }
  return out;
}

Eigenpairs complex_eigenpairs(MatrixXcd a) {
  const int n = static_cast<int>(a.rows()), one = 1;
  Eigenpairs out{Eigen::VectorXcd(n), MatrixXcd(n, n)};
  if (n == 0) return out;
  std::vector<double> real(static_cast<std::size_t>(2 * n));
  const bool found = a.allFinite() && answers<Complex>([&](Complex* work, const int* size, int* info) {
                       zgeev_("N", "V", &n, a.data(), &n, out.values.data(), nullptr, &one, out.vectors.data(), &n,
                              work, size, real.data(), info);
                     });
  if (!found) {
    out.values.setConstant(nothing);
    out.vectors.setConstant(nothing);
    return out;
  }
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](Index i, Index j) { return out.values(i).real() < out.values(j).real(); });
  Eigenpairs sorted = out;
  for (Index k = 0; k < n; ++k) {
    sorted.values(k) = out.values(order[static_cast<std::size_t>(k)]);
    sorted.vectors.col(k) = out.vectors.col(order[static_cast<std::size_t>(k)]);
  }
  return sorted;
}

}  // namespace whirl::spectral
