// Peaks of a resonance that is known in closed form.
#include "study/linear/response_peaks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace whirl::study {
namespace {

// f = 1/sqrt(1 + (2 Q (N/N_0 - 1))^2): 1/f^2 is a parabola with its foot at N_0, and N/(N2 - N1) at 0.707 is Q.
constexpr double top_speed = 283.7, quality = 40;

double height(double speed) {
  const double x = 2 * quality * (speed / top_speed - 1);
  return 1 / std::sqrt(1 + x * x);
}

ResponseCurve sampled(std::vector<double> speeds) {
  std::sort(speeds.begin(), speeds.end());
  ResponseCurve c{speeds, {}};
  for (const double s : c.speed) c.height.push_back(height(s));
  return c;
}

TEST(ResponsePeaks, ASingleResonanceIsMetFromACoarseGrid) {
  std::vector<double> speeds{200, 240, 270, 310, 360};
  std::size_t asked = 0;
  for (int round = 0; round < 2; ++round)
    for (int pass = 0; pass < 10; ++pass) {
      std::vector<double> more;
      const ResponseCurve c = sampled(speeds);
      ASSERT_EQ(c.tops().size(), 1U);
      for (const std::size_t k : c.tops()) round == 0 ? ask_for_top(c, k, pass, more) : ask_for_width(c, k, more);
      if (more.empty()) break;
      asked += more.size();
      speeds.insert(speeds.end(), more.begin(), more.end());
    }
  EXPECT_LE(asked, 4U);  // the parabola and the straight lines of 1/f^2 are exact here
  const ResponseCurve c = sampled(speeds);
  const Peak p = peak_at(c, c.tops().front());
  EXPECT_NEAR(p.speed, top_speed, 1e-9 * top_speed);
  EXPECT_NEAR(p.height, 1, 1e-12);
  EXPECT_NEAR(p.amplification, quality, 1e-9 * quality);
  EXPECT_EQ(p.errors.speed, peak_tolerance);
  EXPECT_GE(p.errors.factor, width_tolerance);
}

TEST(ResponsePeaks, WhatWasNotRefinedIsUnknown) {
  const ResponseCurve c = sampled({200, 240, 270, 310, 360});
  const Peak p = peak_at(c, c.tops().front());
  EXPECT_TRUE(std::isnan(p.errors.speed));
  EXPECT_TRUE(std::isnan(p.errors.height));
  EXPECT_TRUE(std::isnan(p.errors.factor));
}

}  // namespace
}  // namespace whirl::study
