// LU of a band against a sparse LU, with rows of several units.
#include "film/band_lu.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseLU>
#include <cmath>

namespace whirl::film::testing {
namespace {

// Five points of a mesh, `line` nodes in a column; every other row in units a million times larger. Weak diagonals make
// it exchange rows.
Eigen::SparseMatrix<double> mesh(int columns, int line) {
  const int n = columns * line;
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < n; ++k)
    for (const int away : {-line, -1, 0, 1, line})
      if (k + away >= 0 && k + away < n)
        entries.emplace_back(k, k + away,
                             (k % 2 == 0 ? 1.0 : 1e6) * (std::sin(1.7 * k + 0.9 * away) + (away == 0 ? 0.2 : 0)));
  Eigen::SparseMatrix<double> a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

}  // namespace

TEST(BandLu, SolvesWhatASparseLuSolves) {
  const auto a = mesh(30, 6);
  BandLu band(a);
  EXPECT_EQ(BandLu::bandwidth(a), 6);
  EXPECT_TRUE(BandLu::pays(a));
  ASSERT_TRUE(band.factor(a));
  Eigen::SparseLU<Eigen::SparseMatrix<double>> sparse(a);
  Eigen::VectorXd x(a.rows());
  for (int k = 0; k < x.size(); ++k) x(k) = std::cos(0.3 * k);
  EXPECT_LE((band.solve(a * x) - x).norm(), 1e-9 * x.norm());
  EXPECT_LE((band.solve_transposed(a.transpose() * x) - x).norm(), 1e-9 * x.norm());
  EXPECT_LE((band.solve(a * x) - sparse.solve(a * x)).norm(), 1e-9 * x.norm());
}

TEST(BandLu, RefusesWhatIsSingular) {
  auto a = mesh(6, 3);
  BandLu band(a);
  Eigen::SparseMatrix<double> none = a;
  for (int k = 0; k < none.outerSize(); ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator it(none, k); it; ++it)
      if (it.row() == 4) it.valueRef() = 0.0;
  EXPECT_FALSE(band.factor(none));
  for (int k = 0; k < a.outerSize(); ++k)
    for (Eigen::SparseMatrix<double>::InnerIterator it(a, k); it; ++it)
      if (it.col() == 4) it.valueRef() = 0.0;
  EXPECT_FALSE(band.factor(a));
}

// A ring has entries far from the diagonal.
TEST(BandLu, IsNotForRings) {
  auto a = mesh(200, 8);
  EXPECT_TRUE(BandLu::pays(a));
  a.insert(0, a.cols() - 1) = 1.0;
  a.makeCompressed();
  EXPECT_FALSE(BandLu::pays(a));
}

}  // namespace whirl::film::testing
