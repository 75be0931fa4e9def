// Symmetric eigenvalues of a chain of equal masses and springs, 2 - 2 cos(k pi/(n + 1)).

#include "whirl/core/symmetric.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "whirl/core/error.hpp"

using namespace whirl;
using Eigen::MatrixXd;

namespace {

constexpr int n = 7;

MatrixXd chain() {
  MatrixXd a = 2 * MatrixXd::Identity(n, n);
  for (int k = 1; k < n; ++k) a(k, k - 1) = a(k - 1, k) = -1;
  return a;
}

double exact(int k) {
  return 2 - 2 * std::cos((k + 1) * std::numbers::pi / (n + 1));
}

}  // namespace

TEST(Symmetric, AChainHasItsEigenvalues) {
  const core::SymmetricPairs pairs = core::symmetric_pairs(chain(), "a chain");
  for (int k = 0; k < n; ++k) EXPECT_NEAR(pairs.values(k), exact(k), 1e-14);
  EXPECT_LT((pairs.vectors.transpose() * pairs.vectors - MatrixXd::Identity(n, n)).norm(), 1e-13);
}

// (a^-1)_ij = min(i, j) (n + 1 - max(i, j))/(n + 1), counted from one.
TEST(Symmetric, ADefiniteMatrixIsInverted) {
  const MatrixXd inverse = core::solve_definite(chain(), MatrixXd::Identity(n, n), "a chain");
  for (int i = 1; i <= n; ++i)
    for (int j = 1; j <= n; ++j)
      EXPECT_NEAR(inverse(i - 1, j - 1), std::min(i, j) * (n + 1.0 - std::max(i, j)) / (n + 1), 1e-14);
  EXPECT_THROW((void)core::solve_definite(-chain(), MatrixXd::Identity(n, n), "a chain"), core::NotConverged);
}

TEST(Symmetric, OfTwoMatricesTheSecondMakesTheVectorsOne) {
  const MatrixXd mass = 4 * MatrixXd::Identity(n, n) + 0.5 * chain();
  const core::SymmetricPairs pairs = core::symmetric_pairs(chain(), mass, "the mass");
  for (int k = 0; k < n; ++k) EXPECT_NEAR(pairs.values(k), exact(k) / (4 + 0.5 * exact(k)), 1e-14);
  EXPECT_LT((pairs.vectors.transpose() * mass * pairs.vectors - MatrixXd::Identity(n, n)).norm(), 1e-13);
  EXPECT_EQ(core::symmetric_pairs(chain(), mass, "the mass", false).vectors.size(), 0);
}

TEST(Symmetric, WhatHasNoAnswerIsAnError) {
  MatrixXd broken = chain();
  EXPECT_THROW((void)core::symmetric_pairs(chain(), -broken, "the mass"), core::NotConverged);
  broken(3, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)core::symmetric_pairs(broken, "a chain"), core::NotConverged);
}
