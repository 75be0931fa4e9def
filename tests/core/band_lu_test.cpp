// LU of a band against a sparse LU, with rows of several units.
#include "whirl/core/band_lu.hpp"

#include <gtest/gtest.h>

#include <Eigen/SparseLU>
#include <cmath>
#include <limits>
#include <vector>

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

// Entries set in place, and once more with what is added to the diagonal from the eighth row on.
TEST(BandLu, StartsAgainWhereTheDiagonalChanges) {
  constexpr int columns = 9, first = 8;
  for (const int line : {2, 5, 9}) {
    const int n = columns * line;
    Eigen::VectorXd rows(n);
    for (int k = 0; k < n; ++k) rows(k) = k % 2 == 0 ? 1.0 : 1e-6;
    const Eigen::SparseMatrix<double> a = rows.asDiagonal() * mesh(columns, line, 6.0);
    BandLu base(n, line), band(n, line);
    base.clear();
    for (int k = 0; k < n; ++k)
      for (Eigen::SparseMatrix<double>::InnerIterator it(a, k); it; ++it)
        base.entry(static_cast<int>(it.row()), k) = it.value();
    std::vector<double> more(static_cast<std::size_t>(n), 0.0);
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, -1, 2);
    for (const int from : {0, first}) {
      for (int k = first; k < n; ++k) more[static_cast<std::size_t>(k)] = (from + 1) * (k % 3);
      band.factor(base, more, from, first);
      const Eigen::SparseMatrix<double> all =
          a + Eigen::SparseMatrix<double>(Eigen::Map<const Eigen::VectorXd>(more.data(), n).asDiagonal());
      EXPECT_LE((all * band.solve(b) - b).norm(), 1e-13 * b.norm());
      EXPECT_LE((all.transpose() * band.solve_transposed(b) - b).norm(), 1e-13 * b.norm());
    }
    // Without limit: the unknown is held at zero.
    const int held = first + 2;
    more.assign(more.size(), 0.0);
    more[static_cast<std::size_t>(held)] = std::numeric_limits<double>::infinity();
    band.factor(base, more, first, first);
    const Eigen::VectorXd x = band.solve(b);
    EXPECT_EQ(x(held), 0);
    Eigen::VectorXd left = a * x - b;
    left(held) = 0;
    EXPECT_LE(left.norm(), 1e-13 * b.norm());
  }
}

// Ones beside a diagonal of zeros, and twos at a distance of two: A x in whole numbers.
TEST(BandLu, ExchangesRowsWhereTheDiagonalIsZero) {
  constexpr int n = 12;
  Eigen::MatrixXd full = Eigen::MatrixXd::Zero(n, n);
  full.diagonal(1).setOnes();
  full.diagonal(-1).setOnes();
  full.diagonal(2).setConstant(2);
  const Eigen::SparseMatrix<double> a = full.sparseView();
  BandLu band(a);
  ASSERT_TRUE(band.factor(a));
  EXPECT_TRUE(band.exchanged());
  Eigen::MatrixXd x(n, 2);
  for (int i = 0; i < n; ++i) x.row(i) << i + 1, 3 - i * i;
  EXPECT_LT((band.solve(full * x) - x).lpNorm<Eigen::Infinity>(), 1e-11);
  EXPECT_LT((band.solve_transposed(full.transpose() * x) - x).lpNorm<Eigen::Infinity>(), 1e-11);
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
