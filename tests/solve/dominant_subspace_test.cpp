// The leading eigenvalues of a matrix that is known by its products.
#include "solve/cycle/dominant_subspace.hpp"

#include <gtest/gtest.h>

#include <cmath>

using namespace whirl;
using Eigen::Index;
using Eigen::MatrixXd;

// Block triangular: its eigenvalues stand on the diagonal, a pair 0.9 exp(+-i) first, then 0.8 (0.95)^k.
TEST(DominantSubspace, FindsAllAboveTheRadius) {
  constexpr Index n = 120;
  MatrixXd m = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    if (i >= 2) m(i, i) = 0.8 * std::pow(0.95, static_cast<double>(i - 2));
    for (Index j = i + 2; j < n; ++j) m(i, j) = 0.05 * std::sin(static_cast<double>(3 * i + 7 * j));
  }
  m.topLeftCorner(2, 2) << 0.9 * std::cos(1), -0.9 * std::sin(1), 0.9 * std::sin(1), 0.9 * std::cos(1);
  solve::SubspaceOptions options;
  options.radius = 0.5;
  const auto times = [&](const MatrixXd& v) { return MatrixXd(m * v); };
  MatrixXd start(n, 0);
  for (const bool warm : {false, true}) {
    const auto found = solve::dominant_subspace(MPI_COMM_SELF, times, start, options);
    // 0.8 (0.95)^k > 0.5 for k up to 9.
    ASSERT_EQ(found.basis.cols(), 12) << warm;
    ASSERT_GE(found.values.size(), 13U);
    EXPECT_NEAR(found.values[0].real(), 0.9 * std::cos(1), 1e-7);
    EXPECT_NEAR(std::abs(found.values[0].imag()), 0.9 * std::sin(1), 1e-7);
    for (std::size_t k = 0; k < 10; ++k)
      EXPECT_NEAR(std::abs(found.values[k + 2]), 0.8 * std::pow(0.95, static_cast<double>(k)), 1e-7) << k;
    const MatrixXd image = m * found.basis;
    EXPECT_LE((image - found.basis * (found.basis.transpose() * image)).norm(), 1e-7);
    start = found.basis;
  }
}
