// A count tells of eigenvalues that a search has left out.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/small_system.hpp"
#include "whirl/spectral/count.hpp"
#include "whirl/spectral/whirl.hpp"

using namespace whirl;
using test::Column;

namespace {

// n oscillators of frequencies 1, 2, ... with a little damping, and one state that grows at the rate `growth`.
struct Oscillators {
  int n;
  double growth;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T) const {
    Column<T> f(2 * n + 1);
    for (int k = 0; k < n; ++k) {
      const double w = k + 1;
      f(2 * k) = xdot(2 * k) - x(2 * k + 1);
      f(2 * k + 1) = xdot(2 * k + 1) + 0.01 * w * x(2 * k + 1) + w * w * x(2 * k);
    }
    f(2 * n) = xdot(2 * n) - growth * x(2 * n);
    return f;
  }
};

}  // namespace

TEST(CountEigenvalues, TellsWhatASearchHasLeftOut) {
  const int n = 15;
  test::SmallSystem s(MPI_COMM_WORLD, 2 * n + 1, 0, 1, Oscillators{n, 40});
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(2 * n + 1));
  std::vector<spectral::Mode> all = spectral::modes(s, x.get(), {}), found;
  for (const auto& m : all)
    if (m.lambda.imag() > 0 && m.lambda.imag() < 10.5) found.push_back(m);
  ASSERT_EQ(found.size(), 10U);
  const auto complete = spectral::count_eigenvalues(s, x.get(), found);
  EXPECT_GT(complete.radius, 0.4);
  EXPECT_LT(complete.radius, 4);
  EXPECT_EQ(complete.missed, 0);
  EXPECT_TRUE(complete.sure);
  EXPECT_EQ(complete.counted, 2 * static_cast<int>(complete.radius + 0.01));
  EXPECT_LT(complete.factorisations, 120);
  EXPECT_NEAR(complete.real, 40, 1);  // beyond the circle
  found.erase(found.begin());
  const auto without = spectral::count_eigenvalues(s, x.get(), found);
  EXPECT_EQ(without.missed, 2);
  EXPECT_TRUE(without.sure);
  // The growing one inside the circle.
  test::SmallSystem slow(MPI_COMM_WORLD, 2 * n + 1, 0, 1, Oscillators{n, 0.5});
  found.clear();
  for (const auto& m : all)
    if (m.lambda.imag() > 0 && m.lambda.imag() < 10.5) found.push_back(m);
  const auto inside = spectral::count_eigenvalues(slow, x.get(), found);
  EXPECT_EQ(inside.missed, 1);
  EXPECT_EQ(inside.real, 0);
  EXPECT_EQ(spectral::count_eigenvalues(s, x.get(), {}).radius, 0);
}

TEST(Words, OfDamping) {
  EXPECT_DOUBLE_EQ(spectral::damping_ratio({-0.6, 0.8}), 0.6);
  EXPECT_DOUBLE_EQ(spectral::damping_ratio({0.6, -0.8}), -0.6);
  EXPECT_EQ(spectral::damping_ratio({-3, 0}), 1);
  EXPECT_EQ(spectral::damping_ratio({3, 0}), -1);
  EXPECT_EQ(spectral::damping_ratio(0), 0);
  EXPECT_TRUE(spectral::vibrates({-5, 0.1}));
  EXPECT_FALSE(spectral::vibrates({-5, 1e-9}));
  EXPECT_FALSE(spectral::vibrates({5, 0}));
}
