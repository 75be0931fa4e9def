// LU of a band against a sparse LU, with rows of several units.
#include "whirl/core/band_lu.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseLU>
#include <cmath>

namespace whirl::core::testing {
namespace {

// Five points of a mesh, `line` nodes in a column; every other row in units a million times larger. Weak diagonals make
// it exchange rows.
Eigen::SparseMatrix<double> mesh(int columns, int line, double strength = 0.2) {
  const int n = columns * line;
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < n; ++k)
    for (const int away : {-line, -1, 0, 1, line})
      if (k + away >= 0 && k + away < n)
        entries.emplace_back(k, k + away,
                             (k % 2 == 0 ? 1.0 : 1e6) * (std::sin(1.7 * k + 0.9 * away) + (away == 0 ? strength : 0)));
  Eigen::SparseMatrix<double> a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

}  // namespace

TEST(BandLu, SolvesWhatASparseLuSolves) {
  for (const int line : {1, 3, 4, 6, 11})
    for (const double strength : {0.2, 4.0}) {
      const auto a = mesh(30, line, strength);
      BandLu band(a);
      EXPECT_EQ(BandLu::bandwidth(a), line);
      EXPECT_TRUE(BandLu::pays(a));
      ASSERT_TRUE(band.factor(a));
      if (strength > 1.0) {
        EXPECT_FALSE(band.exchanged());
      }
      Eigen::SparseLU<Eigen::SparseMatrix<double>> sparse(a);
      // The transposed matrix answers in units that are those of the rows upside down.
      Eigen::VectorXd x(a.rows()), units(a.rows());
      for (int k = 0; k < x.size(); ++k) {
        x(k) = std::cos(0.3 * k);
        units(k) = k % 2 == 0 ? 1.0 : 1e-6;
      }
      const Eigen::VectorXd w = units.cwiseProduct(x), b = a * x, c = a.transpose() * w;
      const Eigen::VectorXd y = band.solve(b), z = band.solve_transposed(c);
      const auto off = [&](const Eigen::VectorXd& found) { return (found - w).cwiseQuotient(units).norm(); };
      // Weak diagonals lose digits where rows are not exchanged; what is lost comes back with the residual.
      const double lost = strength > 1.0 ? 1e-13 : 1e-6;
      EXPECT_LE((y - x).norm(), lost * x.norm());
      EXPECT_LE(off(z), lost * x.norm());
      EXPECT_LE((y + band.solve(b - a * y) - x).norm(), 1e-11 * x.norm());
      EXPECT_LE(off(z + band.solve_transposed(c - a.transpose() * z)), 1e-11 * x.norm());
      EXPECT_LE((y - sparse.solve(b)).norm(), (1e-9 + lost) * x.norm());
    }
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

}  // namespace whirl::core::testing
