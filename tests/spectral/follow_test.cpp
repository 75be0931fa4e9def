#include "whirl/spectral/follow.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace whirl::spectral {
namespace {

using Complex = std::complex<double>;

// Two oscillators with stiffnesses 1 + d and 1 - d coupled by c: omega^2 = 1 -+ sqrt(d^2 + c^2), shapes
// (cos t, sin t), (-sin t, cos t) with tan 2t = c/d. As d passes zero the frequencies come near and part (veering), and
// each shape turns into the other's.
std::vector<ModePoint> veering(double d, double c) {
  const double t = 0.5 * std::atan2(c, d), r = std::hypot(d, c);
  return {{Complex(0, std::sqrt(1 - r)), {-std::sin(t), std::cos(t)}},
          {Complex(0, std::sqrt(1 + r)), {std::cos(t), std::sin(t)}}};
}

// Without coupling they cross: the shapes stay and the order changes.
std::vector<ModePoint> crossing(double d) {
  std::vector<ModePoint> m{{Complex(0, std::sqrt(1 + d)), {1, 0}}, {Complex(0, std::sqrt(1 - d)), {0, 1}}};
  if (d > 0) std::swap(m[0], m[1]);
  return m;
}

}  // namespace

TEST(Follow, ModesThatCrossKeepTheirShapes) {
  const auto m = match_modes(crossing(-0.05), crossing(0.05), 2);
  EXPECT_TRUE(m.sure);
  EXPECT_EQ(m.before, (std::vector<int>{1, 0}));
}

TEST(Follow, AStepTooLongOverAVeeringIsNotSureAndShorterOnesKeepTheOrder) {
  const double c = 0.02;
  EXPECT_FALSE(match_modes(veering(-0.02, c), veering(0.02, c), 2).sure);
  bool sure = true;
  for (double d = -0.2; d < 0.199; d += 0.004) {
    const auto m = match_modes(veering(d, c), veering(d + 0.004, c), 2);
    sure = sure && m.sure;
    EXPECT_EQ(m.before, (std::vector<int>{0, 1})) << d;
  }
  EXPECT_TRUE(sure);
}

TEST(Follow, AModeThatBeginsHasNoPastAndTheOthersKeepTheirs) {
  // As on a train: an overdamped pair becomes real and another, born from real eigenvalues, looks much alike.
  const std::vector<ModePoint> before{{Complex(-314, 40), {1, 0.3, 0.1}}, {Complex(-4, 78), {0, 0.2, 1}}};
  const std::vector<ModePoint> after{{Complex(-4, 78.1), {0, 0.21, 1}}, {Complex(-428, 114), {1, 0.4, 0.1}}};
  const auto m = match_modes(before, after, 2);
  EXPECT_EQ(m.before, (std::vector<int>{1, -1}));
  EXPECT_FALSE(m.sure);
}

TEST(Follow, ModesBeyondTheCountDoNotMatterButAreRecognised) {
  const std::vector<ModePoint> before{{Complex(0, 10), {1, 0}}, {Complex(0, 20), {0, 1}}};
  const std::vector<ModePoint> after{{Complex(0, 19.9), {0, 1}}};
  const auto m = match_modes(before, after, 1);
  EXPECT_EQ(m.before, (std::vector<int>{1}));
  EXPECT_FALSE(m.sure) << "the first mode has gone";
  EXPECT_TRUE(match_modes({before[1]}, after, 1).sure);
}

}  // namespace whirl::spectral
