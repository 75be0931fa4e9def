#include "study/locus/amplitude_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace whirl::study {
namespace {

// A curve of folds as a rigid rotor has it, p = 1 + 0.6 A^2 + 30 A^4 + ..., known at `n` amplitudes from 0.02 on.
struct Curve {
  std::vector<double> amplitudes, values;
  Curve(int n, double longest, double sixth, double error) {
    for (int k = 0; k < n; ++k) {
      const double a = 0.02 + (longest - 0.02) * k / (n - 1);
      amplitudes.push_back(a);
      // Errors that last for a few points, as those of a time mesh do.
      values.push_back(1 + 0.6 * std::pow(a, 2) + 30 * std::pow(a, 4) + sixth * std::pow(a, 6) +
                       error * std::sin(1.3 * k));
    }
  }
  [[nodiscard]] AtZeroAmplitude at_zero() const { return at_zero_amplitude(amplitudes, values); }
};

TEST(AmplitudeFit, IsExactForTwoPowers) {
  for (const int n : {4, 5, 12}) {
    const AtZeroAmplitude exact = Curve(n, 0.07, 0, 0).at_zero();
    EXPECT_NEAR(exact.value, 1, 1e-13);
    EXPECT_LT(exact.bar, 1e-12);
  }
}

TEST(AmplitudeFit, CoversErrorsOfThePoints) {
  for (const int n : {5, 8, 13, 20, 34})
    for (const double longest : {0.04, 0.055, 0.07}) {
      const AtZeroAmplitude found = Curve(n, longest, 0, 3e-6).at_zero();
      EXPECT_LE(std::abs(found.value - 1), found.bar) << n << " points up to " << longest;
      EXPECT_GT(found.bar, 2e-6);
      EXPECT_LT(found.bar, 2e-4);
    }
}

TEST(AmplitudeFit, CoversAHigherPower) {
  for (const int n : {5, 8, 20}) {
    const AtZeroAmplitude found = Curve(n, 0.07, 3000, 0).at_zero();
    EXPECT_GT(std::abs(found.value - 1), 1e-6);
    EXPECT_LE(std::abs(found.value - 1), found.bar);
    EXPECT_LT(found.bar, 10 * std::abs(found.value - 1));
  }
}

TEST(AmplitudeFit, FewPointsHaveLongBars) {
  for (const int n : {2, 3}) {
    const AtZeroAmplitude found = Curve(n, 0.07, 0, 0).at_zero();
    EXPECT_GT(found.bar, 1e-5);
    EXPECT_LE(std::abs(found.value - 1), found.bar);
    EXPECT_LT(found.bar, 0.01);
  }
}

}  // namespace
}  // namespace whirl::study
