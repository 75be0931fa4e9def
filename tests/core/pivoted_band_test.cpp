// A band that needs exchanges of rows: its diagonal is zero.

#include "whirl/core/pivoted_band.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>

using whirl::core::PivotedBand;

namespace {

constexpr int n = 12;

// Ones beside a diagonal of zeros, and twos at a distance of two: A x in whole numbers.
double entry(int row, int column) {
  const int apart = column - row;
  return apart == 1 || apart == -1 ? 1 : apart == 2 ? 2 : 0;
}

PivotedBand band() {
  PivotedBand a;
  a.resize(n, 2);
  for (int i = 0; i < n; ++i)
    for (int j = std::max(0, i - 2); j < std::min(n, i + 3); ++j) a.at(i, j) = entry(i, j);
  return a;
}

}  // namespace

TEST(PivotedBand, SolvesWithAndWithoutTheTranspose) {
  PivotedBand a = band();
  ASSERT_TRUE(a.factorise());
  Eigen::MatrixXd x(n, 2), direct = Eigen::MatrixXd::Zero(n, 2);
  for (int i = 0; i < n; ++i) x.row(i) << i + 1, 3 - i * i;
  Eigen::VectorXd transposed = Eigen::VectorXd::Zero(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      direct.row(i) += entry(i, j) * x.row(j);
      transposed(j) += entry(i, j) * x(i, 0);
    }
  for (int c = 0; c < 2; ++c) a.solve(direct.col(c).data());
  a.solve_transposed(transposed.data());
  EXPECT_LT((direct - x).lpNorm<Eigen::Infinity>(), 1e-11);
  EXPECT_LT((transposed - x.col(0)).lpNorm<Eigen::Infinity>(), 1e-11);
}

TEST(PivotedBand, TellsSingularMatrices) {
  PivotedBand a;
  a.resize(3, 1);
  a.at(0, 0) = a.at(1, 1) = 1;
  EXPECT_FALSE(a.factorise());
}
