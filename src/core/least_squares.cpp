#include "whirl/core/least_squares.hpp"

#include <algorithm>
#include <complex>
#include <limits>
#include <vector>

#include "whirl/core/error.hpp"
#include "whirl/core/lapack.hpp"

extern "C" {
void dgelsy_(const int* m, const int* n, const int* nrhs, double* a, const int* lda, double* b, const int* ldb,
             int* jpvt, const double* rcond, int* rank, double* work, const int* lwork, int* info);
void zgelsy_(const int* m, const int* n, const int* nrhs, std::complex<double>* a, const int* lda,
             std::complex<double>* b, const int* ldb, int* jpvt, const double* rcond, int* rank,
             std::complex<double>* work, const int* lwork, double* rwork, int* info);
}

namespace whirl::core {
namespace {

using Complex = std::complex<double>;

// `call` takes the arguments of LAPACK's gelsy, without the real workspace of zgelsy.
template <class Matrix, class Call>
Matrix solution(Matrix a, const Matrix& b, const Call& call) {
  require(a.rows() == b.rows(), "as many rows on both sides");
  const int m = static_cast<int>(a.rows()), n = static_cast<int>(a.cols()), columns = static_cast<int>(b.cols()),
            rows = std::max({1, m, n});
  Matrix x = Matrix::Zero(rows, columns);
  x.topRows(m) = b;
  if (m == 0 || n == 0) return Matrix::Zero(n, columns);
  std::vector<int> exchanged(static_cast<std::size_t>(n), 0);
  const double rcond = std::numeric_limits<double>::epsilon() * rows;
  int rank = 0;
  const int info = with_workspace<typename Matrix::Scalar>([&](auto* work, const int* size, int* failed) {
    call(&m, &n, &columns, a.data(), &m, x.data(), &rows, exchanged.data(), &rcond, &rank, work, size, failed);
  });
  require(info == 0, "arguments that LAPACK takes");
  return x.topRows(n);
}

}  // namespace

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return solution(a, b, dgelsy_);
}

Eigen::MatrixXcd least_squares(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  std::vector<double> real(static_cast<std::size_t>(2 * a.cols()));
  return solution(
      a, b,
      [&](const int* m, const int* n, const int* columns, Complex* of, const int* lda, Complex* right, const int* ldb,
          int* exchanged, const double* rcond, int* rank, Complex* work, const int* size, int* info) {
        zgelsy_(m, n, columns, of, lda, right, ldb, exchanged, rcond, rank, work, size, real.data(), info);
      });
}

}  // namespace whirl::core
