// The condensed interval by low-rank updates against the dense one, entry by entry.

#include <gtest/gtest.h>

#include "solve/cycle/linear_part.hpp"
#include "whirl/solve/cycle/interval.hpp"

using namespace whirl;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double apart(const MatrixXd& a, const MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / std::max(1.0, b.cwiseAbs().maxCoeff());
}

// `pairs` rows are of the form alpha x_a' + beta x_b = 0, of which the linear part eliminates those that are named to
// it; the last of three may not be, for its x_a' occurs in another row too.
void compare(int pairs, int eliminated) {
  std::srand(7);
  const int n = 7, r = 2, w = 3;
  for (const auto points : {solve::Points::radau, solve::Points::gauss})
    for (int m = 1; m <= 4; ++m) {
      const solve::Scheme scheme = solve::make_scheme(m, points);
      MatrixXd l1 = MatrixXd::Identity(n, n) + 0.1 * MatrixXd::Random(n, n), l0 = MatrixXd::Random(n, n);
      const MatrixXd b = MatrixXd::Random(n, r), c = MatrixXd::Random(w, n);
      for (int e = 0; e < pairs; ++e) {
        l1.col(2 * e).setZero();
        l1.row(2 * e).setZero();
        l0.row(2 * e).setZero();
        l1(2 * e, 2 * e) = 1 + e;
        l0(2 * e, 2 * e + 1) = -2;
      }
      if (pairs == 3) l1(6, 4) = 0.5;
      std::vector<problem::KinematicRow> kinematic;
      for (int e = 0; e < eliminated; ++e) kinematic.push_back({2 * e, 2 * e, 2 * e + 1});
      std::vector<MatrixXd> tangents, jx, jxdot;
      for (int j = 0; j < m; ++j) {
        tangents.push_back(MatrixXd::Random(r, w));
        jx.push_back(l0 - b * tangents.back() * c);
        jxdot.push_back(l1);
      }
      const double length = 0.3;
      const auto dense = solve::make_dense_interval(scheme, length, jx, jxdot);
      const auto part =
          std::make_shared<solve::LinearPart>(scheme, length, problem::DenseBlocks{l1, l0, b, c, kinematic});
      EXPECT_EQ(part->eliminated(), eliminated);
      const auto low = solve::make_low_rank_interval(part, tangents);

      // The matrix from its definition.
      MatrixXd a(m * n, m * n), a0(m * n, n);
      for (int j = 0; j < m; ++j)
        for (int l = 0; l <= m; ++l) {
          const auto k = static_cast<std::size_t>(j);
          const MatrixXd block = scheme.value(j, l) * jx[k] + scheme.slope(j, l) / length * jxdot[k];
          EXPECT_LE(apart(dense->block(j, l), block), 1e-14);
          EXPECT_LE(apart(low->block(j, l), block), 1e-14);
          if (l == 0)
            a0.middleRows(j * n, n) = block;
          else
            a.block(j * n, (l - 1) * n, n, n) = block;
        }
      const MatrixXd inverse = a.inverse(), gamma = -(inverse * a0).bottomRows(n);
      const MatrixXd y = MatrixXd::Random(m * n, 4), x = MatrixXd::Random(n, 4);
      const VectorXd states = VectorXd::Random(m * n), start = VectorXd::Random(n);
      for (const solve::Interval* interval : {dense.get(), low.get()}) {
        MatrixXd z = y;
        interval->solve(z);
        EXPECT_LE(apart(z, inverse * y), 1e-11);
        z = y;
        interval->solve_transposed(z);
        EXPECT_LE(apart(z, inverse.transpose() * y), 1e-11);
        EXPECT_LE(apart(interval->start(x), a0 * x), 1e-13);
        EXPECT_LE(apart(interval->start_transposed(y), a0.transpose() * y), 1e-13);
        EXPECT_LE(apart(interval->multiply(start, states), a * states + a0 * start), 1e-13);
        const MatrixXd rows = MatrixXd::Random(2, m * n);
        for (const int columns : {1, n, n + 2}) {
          MatrixXd state = MatrixXd::Random(n, columns), added = MatrixXd::Random(2, columns);
          const MatrixXd end = gamma * state, sum = added - rows * (inverse * (a0 * state));
          interval->carry(rows, state, added);
          EXPECT_LE(apart(state, end), 1e-11);
          EXPECT_LE(apart(added, sum), 1e-11);
        }
      }
    }
}

}  // namespace

TEST(Interval, LowRankAndDenseAreTheSameMatrix) {
  compare(0, 0);
}

TEST(Interval, RatesThatAreStatesAreEliminatedExactly) {
  compare(1, 1);
  compare(3, 2);
}
