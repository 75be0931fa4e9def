// Peaks of a resonance that is known in closed form.
#include "study/linear/response_peaks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "study/linear/open_ends.hpp"

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

// A speed without an answer ends the curve as the range does: what rises toward it is no peak.
TEST(ResponsePeaks, AGapIsAnEndOfTheCurve) {
  ResponseCurve c = sampled({200, 240, 270, 282, 283.7, 285, 300, 310, 360});
  ASSERT_EQ(c.tops().size(), 1U);
  c.height[4] = std::nan("");
  EXPECT_TRUE(c.tops().empty());
  // A gap on the flank leaves the peak, without the width that it had there.
  c = sampled({200, 240, 270, 282, 283.7, 285, 300, 310, 360});
  c.height[5] = std::nan("");
  EXPECT_TRUE(c.tops().empty());
  c = sampled({200, 240, 270, 283, 283.7, 284, 300, 310, 360});
  c.height[6] = std::nan("");
  ASSERT_EQ(c.tops().size(), 1U);
  const Peak p = peak_at(c, c.tops().front());
  EXPECT_TRUE(std::isnan(p.amplification));
  EXPECT_EQ(p.no_factor, "above the peak the response does not fall to 0.707 of it before the answers end");
}

TEST(ResponsePeaks, WhatWasNotRefinedIsUnknown) {
  const ResponseCurve c = sampled({200, 240, 270, 310, 360});
  const Peak p = peak_at(c, c.tops().front());
  EXPECT_TRUE(std::isnan(p.errors.speed));
  EXPECT_TRUE(std::isnan(p.errors.height));
  EXPECT_TRUE(std::isnan(p.errors.factor));
}

// A rising curve with a hump of a few per cent on it: its prominence is the height above the dip behind it.
TEST(ResponsePeaks, SaddlesAreAskedOfPeaksThatStandOutLittle) {
  ResponseCurve c{{1, 2, 3, 4, 5, 6, 7}, {0.5, 0.8, 1.0, 0.97, 0.96, 1.2, 1.5}};
  ASSERT_EQ(c.tops(), std::vector<std::size_t>{2});
  const std::vector<double> saddles = saddles_of(c, 2);
  ASSERT_EQ(saddles, (std::vector<double>{1, 5}));
  EXPECT_DOUBLE_EQ(saddle_height(c, saddles), 0.96);
  c.height[4] = 0.85;
  EXPECT_TRUE(saddles_of(c, 2).empty());
}

// Equilibria are known to a tolerance: samples that lie nearer than the curve rises between them jump up and down.
TEST(ResponsePeaks, NoiseOnARisingCurveMakesNoPeaks) {
  ResponseCurve c;
  for (int k = 0; k < 40; ++k) c.speed.push_back(200 + 2.5 * k);
  for (int k = 0; k < 30; ++k) c.speed.push_back(250 * (1 + 1e-9 * k));
  std::sort(c.speed.begin(), c.speed.end());
  for (std::size_t k = 0; k < c.speed.size(); ++k) c.height.push_back(1e-4 * c.speed[k] * (1 + 1e-8 * (k % 2)));
  EXPECT_TRUE(c.tops().empty());
}

TEST(ResponsePeaks, NoiseOnATopLeavesOnePeak) {
  ResponseCurve c;
  for (int k = -20; k <= 20; ++k) c.speed.push_back(top_speed * (1 + 1e-3 * k));
  for (int k = -20; k <= 20; ++k) c.speed.push_back(top_speed * (1 + 1e-4 + 3e-5 * k));
  std::sort(c.speed.begin(), c.speed.end());
  for (std::size_t k = 0; k < c.speed.size(); ++k) c.height.push_back(height(c.speed[k]) * (1 + 2e-7 * (k % 3)));
  ASSERT_EQ(c.tops().size(), 1U);
  EXPECT_NEAR(c.speed[c.tops().front()], top_speed, 1e-4 * top_speed);
}

TEST(ResponsePeaks, NoSpeedIsAskedForTwice) {
  EXPECT_EQ(worth_asking({110, 100.00001, 100, 105, 105.00002}, {90, 100, 120}), (std::vector<double>{105, 110}));
}

// Two resonances, the lower one of which does not come down to 0.707 before the other rises.
TEST(ResponsePeaks, WhyThereIsNoFactorIsSaid) {
  ResponseCurve c;
  for (int k = 0; k <= 400; ++k) {
    const double s = 200 + 0.5 * k, x = 20 * (s / 280 - 1), y = 20 * (s / 320 - 1);
    c.speed.push_back(s);
    c.height.push_back(0.8 / std::sqrt(1 + x * x) + 1 / std::sqrt(1 + y * y));
  }
  const auto tops = c.tops();
  ASSERT_EQ(tops.size(), 2U);
  const Peak low = peak_at(c, tops[0]), high = peak_at(c, tops[1]);
  EXPECT_TRUE(std::isnan(low.amplification));
  EXPECT_NE(low.no_factor.find("above the peak the response does not fall to 0.707 of it before a higher peak rises"),
            std::string::npos)
      << low.no_factor;
  EXPECT_GT(high.amplification, 1);
  EXPECT_TRUE(high.no_factor.empty());
  ResponseCurve cut;
  for (std::size_t k = 0; k < c.speed.size() && c.speed[k] < 325; ++k) {
    cut.speed.push_back(c.speed[k]);
    cut.height.push_back(c.height[k]);
  }
  const Peak last = peak_at(cut, cut.tops().back());
  EXPECT_NE(last.no_factor.find("before the range ends"), std::string::npos) << last.no_factor;
}

// Lines between samples cut no flank: between neighbours within twenty half widths they leave less than a tenth of the
// peak.
TEST(ResponsePeaks, FlanksHaveSamplesEnoughForLines) {
  std::vector<double> speeds{200, 240, 270, 310, 360};
  for (const auto& [passes, ask] : {std::pair{10, 0}, {10, 1}, {1, 2}})
    for (int pass = 0; pass < passes; ++pass) {
      std::vector<double> more;
      const ResponseCurve c = sampled(speeds);
      const std::size_t top = c.tops().front();
      ask == 0   ? ask_for_top(c, top, pass, more)
      : ask == 1 ? ask_for_width(c, top, more)
                 : ask_for_flanks(c, top, more);
      EXPECT_LE(more.size(), 14U);
      speeds.insert(speeds.end(), more.begin(), more.end());
    }
  const ResponseCurve c = sampled(speeds);
  for (std::size_t k = 1; k < speeds.size(); ++k) {
    const double middle = (c.speed[k - 1] + c.speed[k]) / 2;
    if (std::abs(middle - top_speed) < 20 * top_speed / (2 * quality)) {
      EXPECT_NEAR((c.height[k - 1] + c.height[k]) / 2, height(middle), 0.05) << middle;
    }
  }
  std::vector<double> more;
  ask_for_flanks(c, c.tops().front(), more);
  EXPECT_TRUE(more.empty());
}

// Samples of other places that stand about 1/2 half width take the place of that one, and leave no gap behind it.
TEST(ResponsePeaks, FlanksKeepTheRatioOfTheirSamples) {
  constexpr double half = top_speed / (2 * quality);
  for (const double known : {0.29, 0.4, 0.6, 0.95}) {
    std::vector<double> speeds{200, top_speed - half, top_speed, top_speed + known * half, top_speed + half, 360};
    ResponseCurve c = sampled(speeds);
    ask_for_flanks(c, c.tops().front(), speeds);
    std::vector<double> distances;
    for (const double s : sampled(speeds).speed)
      if (s - top_speed > 0.2 * half) distances.push_back((s - top_speed) / half);
    EXPECT_LE(distances.front(), 0.9);
    for (std::size_t k = 1; k < distances.size() && distances[k] < 20; ++k)
      EXPECT_LE(distances[k], 1.8001 * distances[k - 1]) << known;
  }
}

// A range that ends on the flank of a peak; far below a resonance a response rises without one.
TEST(OpenEnds, AreFlanksOfPeaks) {
  const auto part = [](double from, double to) {
    std::vector<double> speeds;
    for (int k = 0; k <= 20; ++k) speeds.push_back(from + (to - from) * k / 20);
    return sampled(speeds);
  };
  for (const double end : {250.0, 275.0, 283.0}) {
    EXPECT_TRUE(ends_on_flank(part(150, end), true)) << end;
    EXPECT_TRUE(ends_on_flank(part(2 * top_speed - end, 450), false)) << end;
  }
  EXPECT_FALSE(ends_on_flank(part(150, 300), true));
  EXPECT_FALSE(ends_on_flank(part(150, 300), false));
  ResponseCurve far;
  for (int k = 1; k <= 20; ++k) {
    far.speed.push_back(10.0 * k);
    far.height.push_back(1e-9 * std::pow(10.0 * k, 2));
  }
  EXPECT_FALSE(ends_on_flank(far, true));
  // Of the resonances of a machine one has to stand there, and to vibrate.
  EXPECT_TRUE(resonance_near({{-3, 280}, {-3, -280}}, 250, 0.1, 0.5));
  EXPECT_FALSE(resonance_near({{-3, 200}, {-3, 400}, {-280, 10}}, 250, 0.1, 0.5));
}

// Behind a peak that is listed a response rises steeply from a dip: no peak beyond belongs to that, unless the machine
// has a resonance there.
TEST(OpenEnds, AreNoneOfTheDipBehindAPeak) {
  std::vector<ResponseAtSpeed> curve;
  for (int k = 0; k <= 60; ++k) {
    const double s = 200 + 2 * k, x = 0.5 * (s - 280);
    const std::complex<double> motion = 1.0 / std::complex<double>(x, 1) - 0.06;
    curve.push_back({s, 1, {{motion, 0}}, {}, {}});
  }
  const auto said = [&](std::vector<ResponseAtSpeed> part, const std::vector<std::complex<double>>& modes) {
    const double end = part.back().speed;
    return open_ends(part, places_of({1}, {}), {{end, modes}}, "rad/s");
  };
  EXPECT_TRUE(ends_on_flank(curve_at(curve, &ResponseAtSpeed::nodes, 0), true));
  EXPECT_TRUE(said(curve, {{-2, 300}, {-2, 500}}).empty());
  EXPECT_EQ(said(curve, {{-2, 300}, {-2, 400}}).size(), 1U);
  curve.resize(35);
  EXPECT_EQ(said(curve, {{-2, 262}}).size(), 1U) << "no peak is listed";
}

}  // namespace
}  // namespace whirl::study
