// Left vectors, condition numbers, multiplicities; how nodes turn.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/dense.hpp"
#include "support/small_system.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/spectral/whirl.hpp"

using namespace whirl;
using spectral::Complex;
using spectral::Sense;
using test::Column;

namespace {

// A damped gyroscopic chain, whose left vectors are not its right ones: q' = v, v' = -K q - C v - G v in scales that
// are not one.
struct GyroscopicChain {
  int pairs;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T) const {
    const int n = 2 * pairs;
    Column<T> f(2 * n);
    for (int k = 0; k < n; ++k) {
      f(k) = xdot(k) - x(n + k);
      f(n + k) = (2.0 + 0.1 * k) * xdot(n + k) + 0.05 * (1 + k % 3) * x(n + k) + 2.0 * x(k);
      f(n + k) += (k % 2 == 0 ? 0.3 : -0.3) * x(n + (k % 2 == 0 ? k + 1 : k - 1));
      if (k > 1) f(n + k) -= x(k - 2);
      if (k + 2 < n) f(n + k) -= 1.1 * x(k + 2);
    }
    return f;
  }
};

Eigen::VectorXcd vector(const std::vector<Complex>& v) {
  return Eigen::Map<const Eigen::VectorXcd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

spectral::EigenOptions with_left(bool dense, int count) {
  spectral::EigenOptions o;
  o.left = true;
  o.count = count;
  if (!dense) o.dense_below = 0;
  return o;
}

}  // namespace

// y* (A - lambda B) = 0 and y_i* B x_j = delta_ij in SI, by LAPACK and by two searches; both say the same of condition.
TEST(LeftVectors, AreBiorthogonalAndSolveTheirEquations) {
  const int pairs = 12, n = 4 * pairs;
  test::SmallSystem s(MPI_COMM_WORLD, n, 0, 1, GyroscopicChain{pairs});
  Eigen::VectorXd state(n), row(n);
  for (int k = 0; k < n; ++k) {
    state(k) = std::pow(10.0, (k % 5) - 2);
    row(k) = std::pow(10.0, 1 - (k % 3));
  }
  s.set_scales(state, row);
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(n));
  core::Matrix jx = s.make_jacobian(), jd = s.make_jacobian();
  s.jacobian(0, x.get(), x.get(), 1, 0, jx.get());
  s.jacobian(0, x.get(), x.get(), 0, -1, jd.get());
  const Eigen::MatrixXd a = test::dense(jx.get()), b = test::dense(jd.get());
  std::vector<double> condition;
  for (const bool dense : {true, false}) {
    const auto modes = spectral::modes(s, x.get(), with_left(dense, 16));
    for (std::size_t k = 0; k < 6; ++k) {
      const Eigen::VectorXcd y = vector(modes[k].left);
      ASSERT_EQ(y.size(), n);
      const Eigen::RowVectorXcd residual = y.adjoint() * (a.cast<Complex>() - modes[k].lambda * b.cast<Complex>());
      const Eigen::RowVectorXd size =
          y.cwiseAbs().transpose() * (a.cwiseAbs() + std::abs(modes[k].lambda) * b.cwiseAbs());
      EXPECT_LE(residual.cwiseAbs().cwiseQuotient(size).maxCoeff(), dense ? 1e-9 : 1e-6) << dense << k;
      for (std::size_t j = 0; j < 6; ++j) {
        const Complex product = y.adjoint() * (b * vector(modes[j].shape));
        EXPECT_NEAR(std::abs(product - (j == k ? 1.0 : 0.0)), 0, 1e-6) << dense << " " << j << " " << k;
      }
      EXPECT_GE(modes[k].condition, 1 - 1e-12);
      if (dense)
        condition.push_back(modes[k].condition);
      else
        EXPECT_NEAR(modes[k].condition, condition[k], 1e-5 * condition[k]);
    }
  }
}

// [a c; 0 b]: both eigenvalues have the condition number sqrt(1 + c^2/(a - b)^2).
TEST(LeftVectors, ConditionOfATriangle) {
  const double a = -1, b = -1.5, c = 40;
  test::SmallSystem s(MPI_COMM_WORLD, 8, 0, 1, [&]<class T>(double, const Column<T>& x, const Column<T>& xdot, T) {
    Column<T> f = xdot;
    f(0) -= a * x(0) + c * x(1);
    f(1) -= b * x(1);
    for (int k = 2; k < 8; ++k) f(k) += (k + 1.0) * x(k);
    return f;
  });
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(8));
  for (const bool dense : {true, false}) {
    auto modes = spectral::modes(s, x.get(), with_left(dense, 4));
    ASSERT_GE(modes.size(), 3U);
    for (const auto& m : modes) {
      const double wanted = m.lambda.real() > -2 ? std::hypot(1, c / (a - b)) : 1;
      EXPECT_NEAR(m.condition, wanted, 1e-6 * wanted) << dense << m.lambda;
      EXPECT_FALSE(m.defective());
    }
  }
}

// Two masses that are free, one of which has a twin: zero is an eigenvalue of multiplicity four with two vectors. Equal
// oscillators are a double eigenvalue with two.
TEST(LeftVectors, MultipleEigenvaluesWithAndWithoutTheirVectors) {
  test::SmallSystem s(MPI_COMM_WORLD, 8, 0, 1, []<class T>(double, const Column<T>& x, const Column<T>& xdot, T) {
    Column<T> f(8);
    for (int k = 0; k < 8; k += 2) {
      f(k) = xdot(k) - x(k + 1);
      f(k + 1) = xdot(k + 1);
      if (k >= 4) f(k + 1) += 9.0 * x(k) + 0.1 * x(k + 1);
    }
    return f;
  });
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(8));
  const auto modes = spectral::modes(s, x.get(), with_left(true, 8));
  int zeros = 0, others = 0;
  for (const auto& m : modes) {
    if (std::abs(m.lambda) < 1) {
      ++zeros;
      EXPECT_EQ(m.multiplicity, 4);
      EXPECT_EQ(m.vectors, 2);
      EXPECT_TRUE(m.defective());
      EXPECT_GE(m.condition, 1e6);
    } else {
      ++others;
      EXPECT_EQ(m.multiplicity, 2);
      EXPECT_FALSE(m.defective());
      EXPECT_LE(m.condition, 10);
    }
  }
  EXPECT_GE(zeros, 2);
  EXPECT_EQ(others, 2);
}

// Analytic ellipses x = a cos, y = b sin: turning 2 a b/(a^2 + b^2).
TEST(Turning, OfEllipsesLinesAndNodesAtRest) {
  const Complex i(0, 1);
  const auto t = spectral::turning({1, 1, 1, 2, 1e-9}, {-i, 0.5 * i, 1, -1.0 * i, 1e-9 * i});
  EXPECT_DOUBLE_EQ(t[0], 1);
  EXPECT_DOUBLE_EQ(t[1], -0.8);
  EXPECT_DOUBLE_EQ(t[2], 0);
  EXPECT_DOUBLE_EQ(t[3], 0.8);
  EXPECT_DOUBLE_EQ(t[4], 0);  // moves too little to tell
}

TEST(Turning, SenseByNodesAndWhereEnergySaysOtherwise) {
  const Complex i(0, 1);
  const auto both = [](const std::vector<Complex>& x, const std::vector<Complex>& y) {
    return std::pair(spectral::sense_by_nodes(spectral::turning(x, y)), spectral::sense_of_whirl(x, y));
  };
  using Senses = std::pair<Sense, Sense>;
  EXPECT_EQ(both({1, 2}, {0.5, -1}), Senses(Sense::planar, Sense::planar));
  EXPECT_EQ(both({1, 2}, {-0.5 * i, -2.0 * i}), Senses(Sense::forward, Sense::forward));
  EXPECT_EQ(both({1, 2}, {0.5 * i, 2.0 * i}), Senses(Sense::backward, Sense::backward));
  EXPECT_EQ(both({1, 2}, {-i, 2.0 * i}), Senses(Sense::mixed, Sense::mixed));
  // One node on a line says nothing.
  EXPECT_EQ(both({1, 2}, {1, 2.0 * i}), Senses(Sense::backward, Sense::backward));
  // A node that hardly moves counts by the rule and weighs nothing; a slim ellipse turns by the rule and is a line to
  // the energy.
  EXPECT_EQ(both({1, 0.01}, {-i, 0.01 * i}), Senses(Sense::mixed, Sense::forward));
  EXPECT_EQ(both({1}, {-0.01 * i}), Senses(Sense::forward, Sense::planar));
}
