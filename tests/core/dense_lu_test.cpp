#include "whirl/core/dense_lu.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "whirl/core/least_squares.hpp"
#include "whirl/core/pivoted_lu.hpp"

namespace whirl::core {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Zeros on the diagonal, so that rows have to be exchanged.
template <class Scalar>
typename DenseLu<Scalar>::Matrix matrix(Index n) {
  typename DenseLu<Scalar>::Matrix a(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const Complex z = i == j ? Complex(0) : std::polar(1.0 + 0.3 * std::sin(3.0 * i + j), 0.7 * i - 1.1 * j * j);
      if constexpr (std::is_same_v<Scalar, double>)
        a(i, j) = z.real();
      else
        a(i, j) = z;
    }
  return a;
}

template <class Scalar>
void solves_both_ways() {
  const auto a = matrix<Scalar>(7);
  const DenseLu<Scalar> dense(a);
  const PivotedLu<Scalar> sparse(a.sparseView());
  ASSERT_TRUE(sparse.regular());
  for (const Index columns : {1, 3}) {
    const typename DenseLu<Scalar>::Matrix x = matrix<Scalar>(7).leftCols(columns);
    EXPECT_LT((dense.solve(a * x) - x).norm(), 1e-12);
    EXPECT_LT((dense.solve_transposed(a.transpose() * x) - x).norm(), 1e-12);
    EXPECT_LT((sparse.solve(a * x) - x).norm(), 1e-12);
    EXPECT_LT((sparse.solve_transposed(a.transpose() * x) - x).norm(), 1e-12);
  }
  EXPECT_LT((dense.inverse() * a - DenseLu<Scalar>::Matrix::Identity(7, 7)).norm(), 1e-12);
}

TEST(DenseLu, SolvesBothWays) {
  solves_both_ways<double>();
  solves_both_ways<Complex>();
}

TEST(DenseLu, TellsHowNearToSingular) {
  Eigen::MatrixXd a = Eigen::Vector3d(1, 2, 1e-9).asDiagonal();
  EXPECT_NEAR(DenseLu<double>(a).rcond(), 5e-10, 1e-15);
  a(2, 2) = 0;
  EXPECT_EQ(DenseLu<double>(a).rcond(), 0);
}

TEST(PivotedLu, GivesTheAngleOfTheDeterminant) {
  // det [0 2i; 3 0] = -6i, and of a permutation that is odd: -1.
  Eigen::MatrixXcd a = Eigen::MatrixXcd::Zero(2, 2);
  a(0, 1) = Complex(0, 2);
  a(1, 0) = 3;
  const PivotedLu<Complex> lu(a.sparseView());
  EXPECT_NEAR(std::abs(std::polar(1.0, lu.angle()) - Complex(0, -1)), 0, 1e-14);
  Eigen::MatrixXd odd = Eigen::MatrixXd::Zero(3, 3);
  odd(0, 1) = odd(1, 0) = odd(2, 2) = 1;
  EXPECT_NEAR(std::cos(PivotedLu<double>(odd.sparseView()).angle()), -1, 1e-14);
}

TEST(PivotedLu, TellsOfSingularMatrices) {
  Eigen::MatrixXd a = Eigen::MatrixXd::Ones(3, 3);
  EXPECT_FALSE(PivotedLu<double>(a.sparseView()).regular());
}

TEST(LeastSquares, FitsALine) {
  // y = 0, 1, 1 at x = 0, 1, 2: the line 1/6 + x/2.
  Eigen::MatrixXd a(3, 2);
  a << 1, 0, 1, 1, 1, 2;
  const Eigen::MatrixXd fit = least_squares(a, Eigen::MatrixXd(Eigen::Vector3d(0, 1, 1)));
  EXPECT_NEAR(fit(0), 1.0 / 6, 1e-14);
  EXPECT_NEAR(fit(1), 1.0 / 2, 1e-14);
}

TEST(LeastSquares, TakesTheShortestOfManyAnswers) {
  // x + y = 2 and its double: (1, 1).
  Eigen::MatrixXcd a(2, 2), b(2, 1);
  a << 1, 1, 2, 2;
  b << 2, 4;
  const Eigen::MatrixXcd x = least_squares(a, b);
  EXPECT_NEAR(std::abs(x(0) - 1.0) + std::abs(x(1) - 1.0), 0, 1e-14);
}

}  // namespace
}  // namespace whirl::core
