#include "whirl/core/sparse_lu.hpp"

#include <gtest/gtest.h>

namespace whirl::core {
namespace {

using Matrix = SparseLu::Matrix;

// Flow between neighbours on a ring of n lines of m nodes, more with the stream than against it, and storage.
Matrix mesh(int n, int m, double storage) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto place = [&](int i, int j) { return (i + n) % n * m + j; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      const int here = place(i, j);
      entries.emplace_back(here, here, 5 + storage);
      entries.emplace_back(here, place(i + 1, j), -0.8);
      entries.emplace_back(here, place(i - 1, j), -1.2);
      if (j > 0) entries.emplace_back(here, here - 1, -1.5);
      if (j < m - 1) entries.emplace_back(here, here + 1, -1.5);
    }
  Matrix s(n * m, n * m);
  s.setFromTriplets(entries.begin(), entries.end());
  return s;
}

double error(const SparseLu& f, const Matrix& s) {
  const Eigen::MatrixXd x = Eigen::MatrixXd::Random(s.rows(), 3);
  return ((f.solve(Eigen::MatrixXd(s * x)) - x).norm() + (f.solve_transposed(s.transpose() * x) - x).norm()) / x.norm();
}

TEST(SparseLu, SolveOnAMeshWithoutPivots) {
  SparseLu f;
  for (const double storage : {0.1, 3.0}) {  // one pattern twice, and another one
    ASSERT_TRUE(f.compute(mesh(24, 7, storage)));
    EXPECT_LT(error(f, mesh(24, 7, storage)), 1e-12);
  }
  ASSERT_TRUE(f.compute(mesh(16, 5, 0.1)));
  EXPECT_LT(error(f, mesh(16, 5, 0.1)), 1e-12);
  EXPECT_FALSE(f.takes_pivots());
}

TEST(SparseLu, TakePivotsWhereTheyMust) {
  // Rows in an order of which the diagonal is empty: every first pivot is zero. And one whose first pivot is rounding.
  const Matrix s = mesh(8, 3, 1);
  Eigen::PermutationMatrix<Eigen::Dynamic> turn(s.rows());
  for (int i = 0; i < turn.size(); ++i) turn.indices()(i) = (i + 12) % static_cast<int>(turn.size());
  const Matrix turned = turn * s;
  Matrix tiny = s;
  for (int k = 0; k < tiny.rows(); ++k) tiny.coeffRef(k, k) = 1e-14;
  for (const Matrix& m : {turned, tiny}) {
    SparseLu f;
    ASSERT_TRUE(f.compute(m));
    EXPECT_TRUE(f.takes_pivots());
    EXPECT_LT(error(f, m), 1e-9);
  }
}

TEST(SparseLu, RefuseASingularMatrix) {
  Matrix s = mesh(8, 3, 1);
  for (int k = 0; k < s.outerSize(); ++k)
    for (Matrix::InnerIterator e(s, k); e; ++e)
      if (e.row() == 5) e.valueRef() = 0;
  SparseLu f;
  EXPECT_FALSE(f.compute(s));
}

}  // namespace
}  // namespace whirl::core
