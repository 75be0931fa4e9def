// Collocation tables: exact on polynomials, of the promised quadrature order.

#include <gtest/gtest.h>

#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/solve/cycle/scheme.hpp"

using namespace whirl;
using solve::Points;

TEST(Scheme, ValuesAndSlopesAreExactOnPolynomialsOfTheDegree) {
  for (const Points points : {Points::radau, Points::gauss})
    for (int m = 1; m <= 10; ++m) {
      const solve::Scheme s = solve::make_scheme(m, points);
      ASSERT_EQ(s.value.rows(), m);
      ASSERT_EQ(s.value.cols(), m + 1);
      EXPECT_EQ(s.node(0), 0);
      EXPECT_NEAR(s.node(m), 1, 1e-15);
      for (int k = 0; k <= m; ++k) {
        const Eigen::VectorXd at_nodes = s.node.array().pow(k);
        for (int j = 0; j < m; ++j) {
          EXPECT_NEAR(s.value.row(j).dot(at_nodes), std::pow(s.c(j), k), 1e-11);
          EXPECT_NEAR(s.slope.row(j).dot(at_nodes), k == 0 ? 0 : k * std::pow(s.c(j), k - 1), 1e-9);
        }
        EXPECT_NEAR(solve::lagrange(s, 0.37).dot(at_nodes), std::pow(0.37, k), 1e-11);
        EXPECT_NEAR(solve::lagrange_slope(s, 0.37).dot(at_nodes), k == 0 ? 0 : k * std::pow(0.37, k - 1), 1e-9);
      }
    }
}

TEST(Scheme, QuadratureIsExactUpToItsOrderAndNoFurther) {
  for (const Points points : {Points::radau, Points::gauss})
    for (int m = 1; m <= 6; ++m) {
      const solve::Scheme s = solve::make_scheme(m, points);
      EXPECT_EQ(s.order(), points == Points::radau ? 2 * m - 1 : 2 * m);
      for (int k = 0; k <= s.order(); ++k) {
        const double error = std::abs(s.weight.dot(Eigen::VectorXd(s.c.array().pow(k))) - 1.0 / (k + 1));
        if (k < s.order())
          EXPECT_LE(error, 1e-14) << m << " " << k;
        else
          EXPECT_GE(error, 1e-9) << m << " " << k;
      }
    }
}

// Radau IIA of two and three stages: Hairer and Wanner 1996, tables 5.5 and 5.6.
TEST(Scheme, RadauPointsOfTheBooks) {
  for (int m = 1; m <= 10; ++m) EXPECT_EQ(solve::make_scheme(m, Points::radau).c(m - 1), 1);
  const solve::Scheme two = solve::make_scheme(2, Points::radau), three = solve::make_scheme(3, Points::radau);
  EXPECT_NEAR(two.c(0), 1.0 / 3, 1e-15);
  EXPECT_NEAR(two.weight(0), 0.75, 1e-15);
  EXPECT_NEAR(three.c(0), (4 - std::sqrt(6.0)) / 10, 1e-15);
  EXPECT_NEAR(three.c(1), (4 + std::sqrt(6.0)) / 10, 1e-15);
  EXPECT_NEAR(three.weight(2), 1.0 / 9, 1e-15);
}

// By hand, of Radau IIA of two stages: A = [5/12 -1/12; 3/4 1/4].
TEST(Scheme, LowerFactorOfRadau) {
  const Eigen::Matrix2d a{{5.0 / 12, -1.0 / 12}, {0.75, 0.25}}, l{{5.0 / 12, 0}, {0.75, 0.4}};
  EXPECT_TRUE(solve::lower_factor(a).isApprox(l, 1e-15));
}

TEST(Scheme, RejectsOtherDegrees) {
  EXPECT_THROW((void)solve::make_scheme(0, Points::radau), core::InputError);
  EXPECT_THROW((void)solve::make_scheme(11, Points::gauss), core::InputError);
}
