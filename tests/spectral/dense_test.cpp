// Decompositions by LAPACK against their definitions and values known in closed form.

#include "whirl/spectral/dense.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using namespace whirl;
using Eigen::Index;
using Eigen::MatrixXcd;
using spectral::Complex;

MatrixXcd some(Index rows, Index columns) {
  MatrixXcd a(rows, columns);
  for (Index i = 0; i < a.size(); ++i) {
    const auto k = static_cast<double>(i);
    a.data()[i] = {std::sin(1 + 1.7 * k), std::cos(0.3 * k * k)};
  }
  return a;
}

double off(const MatrixXcd& a, const MatrixXcd& b) {
  return (a - b).norm();
}

}  // namespace

TEST(Dense, SingularValuesAndVectorsGiveTheMatrixAgain) {
  for (const auto& [rows, columns] : {std::pair<Index, Index>{9, 4}, {4, 9}, {5, 5}, {1, 1}}) {
    const MatrixXcd a = some(rows, columns);
    const spectral::Svd s = spectral::svd(a);
    const Index least = std::min(rows, columns);
    ASSERT_EQ(s.sizes.size(), least);
    EXPECT_LT(off(s.u * s.sizes.cast<Complex>().asDiagonal() * s.v.adjoint(), a), 1e-13 * a.norm());
    EXPECT_LT(off(s.u.adjoint() * s.u, MatrixXcd::Identity(least, least)), 1e-13);
    EXPECT_LT(off(s.v.adjoint() * s.v, MatrixXcd::Identity(least, least)), 1e-13);
    for (Index k = 1; k < least; ++k) EXPECT_GE(s.sizes(k - 1), s.sizes(k));
    EXPECT_LT((spectral::singular_values(a) - s.sizes).norm(), 1e-13 * s.sizes(0));
  }
}

TEST(Dense, RealMatricesHaveTheirSingularValues) {
  Eigen::MatrixXd a(2, 2);
  a << 3, 0, 4, 5;  // a a^T has the eigenvalues 45 and 5
  const Eigen::VectorXd sizes = spectral::singular_values(a);
  EXPECT_NEAR(sizes(0), std::sqrt(45.0), 1e-13);
  EXPECT_NEAR(sizes(1), std::sqrt(5.0), 1e-13);
}

TEST(Dense, TheLeastDirectionIsNullWhereThereAreFewerRowsThanColumns) {
  const MatrixXcd wide = some(3, 5), tall = some(7, 3);
  const Eigen::VectorXcd x = spectral::least_direction(wide), y = spectral::least_direction(tall);
  EXPECT_NEAR(x.norm(), 1, 1e-13);
  EXPECT_LT((wide * x).norm(), 1e-13 * wide.norm());
  EXPECT_NEAR(y.norm(), 1, 1e-13);
  EXPECT_NEAR((tall * y).norm(), spectral::svd(tall).sizes(2), 1e-13 * tall.norm());
}

TEST(Dense, EigenpairsOfAComplexMatrix) {
  const MatrixXcd a = some(6, 6);
  const spectral::Eigenpairs pairs = spectral::complex_eigenpairs(a);
  EXPECT_LT(off(a * pairs.vectors, pairs.vectors * pairs.values.asDiagonal()), 1e-12 * a.norm());
  EXPECT_NEAR(std::abs(pairs.values.sum() - a.trace()), 0, 1e-13 * a.norm());
  for (Index k = 0; k < 6; ++k) EXPECT_NEAR(pairs.vectors.col(k).norm(), 1, 1e-13);
  for (Index k = 1; k < 6; ++k) EXPECT_LE(pairs.values(k - 1).real(), pairs.values(k).real());
}

TEST(Dense, WhatIsNotFiniteHasNoAnswer) {
  MatrixXcd a = some(4, 4);
  a(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(spectral::svd(a).sizes(0)));
  EXPECT_TRUE(std::isnan(spectral::least_direction(a)(0).real()));
  EXPECT_TRUE(std::isnan(spectral::complex_eigenpairs(a).values(0).real()));
}

TEST(Dense, RealMatricesHaveTheirEigenpairs) {
  // A turn by 0.3 in one plane, which has a pair, beside a real eigenvalue.
  Eigen::MatrixXd a(3, 3);
  a << std::cos(0.3), -std::sin(0.3), 1, std::sin(0.3), std::cos(0.3), 2, 0, 0, -4;
  const spectral::Eigenpairs pairs = spectral::real_eigenpairs(a, true);
  for (const Complex exact : {std::polar(1.0, 0.3), std::polar(1.0, -0.3), Complex(-4)})
    EXPECT_LT((pairs.values.array() - exact).abs().minCoeff(), 1e-14);
  for (Index k = 0; k < 3; ++k) {
    EXPECT_NEAR(pairs.vectors.col(k).norm(), 1, 1e-14);
    EXPECT_LT((a.cast<Complex>() * pairs.vectors.col(k) - pairs.values(k) * pairs.vectors.col(k)).norm(), 1e-14);
  }
  EXPECT_EQ(spectral::real_eigenpairs(a, false).vectors.size(), 0);
  a(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(spectral::real_eigenpairs(a, true).values(0).real()));
}
