// A hub with a border against dense LU of all of it: regular, singular to rounding, singular by a row of zeros.

#include "solve/newton/frequency_hub.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numeric>

namespace whirl {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

// Coordinates q and rates v of a chain: q' - v = 0 and v' + 0.1 v + k q = 0, the last row empty where one is free.
struct Chain {
  MatrixXd a, b;
};
Chain chain(Index n, bool free) {
  Chain out{MatrixXd::Zero(2 * n, 2 * n), MatrixXd::Identity(2 * n, 2 * n)};
  out.a.topRightCorner(n, n) = -MatrixXd::Identity(n, n);
  out.a.bottomRightCorner(n, n) = 0.1 * MatrixXd::Identity(n, n);
  for (Index i = 0; i < n; ++i) {
    out.a(n + i, i) = 2 + 0.3 * static_cast<double>(i);
    if (i > 0) out.a(n + i, i - 1) = out.a(n + i - 1, i) = -1;
  }
  if (free) {
    out.a.row(2 * n - 1).setZero();
    out.b.row(2 * n - 1).setZero();
  }
  return out;
}

void agrees(const Chain& c, Complex lambda) {
  const Index n = c.a.cols();
  solve::FrequencyHub hub;
  const MatrixXd both = c.a.cwiseAbs() + c.b.cwiseAbs();
  hub.a = hub.b = both.sparseView();
  for (int k = 0; k < n; ++k)
    for (int e = hub.a.outerIndexPtr()[k]; e < hub.a.outerIndexPtr()[k + 1]; ++e) {
      hub.a.valuePtr()[e] = c.a(hub.a.innerIndexPtr()[e], k);
      hub.b.valuePtr()[e] = c.b(hub.a.innerIndexPtr()[e], k);
    }
  std::vector<problem::KinematicRow> kinematic;
  for (int k = 0; k < n / 2; ++k) kinematic.push_back({k, k, static_cast<int>(n / 2) + k});
  hub.linearise(kinematic);
  VectorXcd column(n), row(n), r(n + 1);
  for (Index k = 0; k <= n; ++k) {
    const auto t = static_cast<double>(k);
    r(k) = {std::sin(1 + t), std::cos(t)};
    if (k == n) break;
    column(k) = {std::cos(1 + 0.7 * t), std::sin(3 * t)};
    row(k) = {std::sin(2 + 1.3 * t), std::cos(1.7 * t)};
  }
  const Complex corner(0.3, -0.2), part(0.5, 0.4);
  MatrixXcd whole(n + 1, n + 1);
  whole << c.a + lambda * c.b, column, row.transpose(), corner;
  // A film's block reaches into the border as well.
  const int last = static_cast<int>(n);
  whole(n - 2, 0) += part;
  whole(n - 2, n) += part;
  whole(n, 0) += part;
  whole(n, n) += part;
  std::vector<int> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  const bool regular = hub.factorise(lambda,
                                     {{all, {last}, column},
                                      {{last}, all, row.transpose()},
                                      {{last}, {last}, MatrixXcd::Constant(1, 1, corner)},
                                      {{last - 2, last}, {0, last}, MatrixXcd::Constant(2, 2, part)}},
                                     1);
  ASSERT_TRUE(regular);
  const VectorXcd x = whole.partialPivLu().solve(r), y = whole.adjoint().partialPivLu().solve(r);
  EXPECT_LE((hub.solve(r) - x).norm(), 1e-11 * x.norm());
  EXPECT_LE((hub.solve_adjoint(r) - y).norm(), 1e-11 * y.norm());
}

TEST(FrequencyHub, BordersAreSolvedAroundTheRest) {
  agrees(chain(7, false), {0.2, 1.3});
}

// At the eigenvalues of the rest with the block of the film.
TEST(FrequencyHub, TheRestMayBeSingularToRounding) {
  const Chain c = chain(7, false);
  MatrixXcd rest = c.a.cast<Complex>();
  rest(c.a.rows() - 2, 0) += Complex(0.5, 0.4);
  const VectorXcd values = (-rest).eigenvalues();  // b is the unit matrix
  for (Index k = 0; k < values.size(); ++k) agrees(c, values(k));
}

TEST(FrequencyHub, ARowOfZerosIsFactorisedWithItsBorder) {
  const Chain c = chain(7, true);
  agrees(c, {0.2, 1.3});
}

}  // namespace
}  // namespace whirl
