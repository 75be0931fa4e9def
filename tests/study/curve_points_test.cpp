// Which points of a curve are kept with their solutions.
#include "study/locus/curve_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "study/packed.hpp"

namespace whirl::study {
namespace {

CurvePoint point(std::size_t row, double arclength) {
  CurvePoint p;
  p.cycle = {{0, 1}, Eigen::MatrixXd::Constant(2, 1, arclength), 0.5, 10 * arclength};
  p.inner = Eigen::VectorXd::Constant(1, arclength);
  p.second = -arclength;
  p.arclength = arclength;
  p.row = row;
  return p;
}

// Steps that grow sixty-fold: points that are near each other must not crowd out the rest of the curve.
SpreadPoints grown(std::size_t count) {
  SpreadPoints spread(8);
  double length = 0;
  for (std::size_t k = 0; k < count; ++k) {
    spread.add(point(k, length));
    length += 0.001 * (k < 60 ? 1.0 : 60.0);
  }
  return spread;
}

TEST(SpreadPoints, CoverAGrowingCurveWithBothEnds) {
  for (const std::size_t count : {1, 2, 8, 9, 30, 61, 100, 500}) {
    const std::vector<CurvePoint> kept = grown(count).all();
    ASSERT_LE(kept.size(), 9U);
    EXPECT_EQ(kept.front().row, 0U);
    EXPECT_EQ(kept.back().row, count - 1);
    double widest = 0;
    for (std::size_t k = 1; k < kept.size(); ++k) {
      EXPECT_LT(kept[k - 1].row, kept[k].row);
      widest = std::max(widest, kept[k].arclength - kept[k - 1].arclength);
    }
    if (count > 1) {
      EXPECT_LE(widest, std::max(0.5 * kept.back().arclength, 0.0601)) << count;
    }
  }
}

TEST(SpreadPoints, SurviveACheckpoint) {
  const SpreadPoints before = grown(75);
  SpreadPoints after(8);
  unpack(pack(before), after);
  SpreadPoints whole = before;
  for (std::size_t k = 75; k < 90; ++k) {
    whole.add(point(k, 10 + 0.01 * static_cast<double>(k)));
    after.add(point(k, 10 + 0.01 * static_cast<double>(k)));
  }
  const auto a = whole.all(), b = after.all();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].row, b[k].row);
    EXPECT_EQ(a[k].arclength, b[k].arclength);
    EXPECT_EQ(a[k].second, b[k].second);
    EXPECT_EQ(a[k].inner, b[k].inner);
    EXPECT_EQ(a[k].cycle.x, b[k].cycle.x);
    EXPECT_EQ(a[k].cycle.parameter, b[k].cycle.parameter);
  }
}

TEST(EvenlySpread, TakesBothEndsAndPointsNextToEvenPlaces) {
  std::vector<CurvePoint> points;
  for (const double s : {0.0, 0.01, 0.02, 0.49, 0.52, 0.98, 1.0}) points.push_back(point(points.size(), s));
  const auto three = evenly_spread(points, 3);
  ASSERT_EQ(three.size(), 3U);
  EXPECT_EQ(three[0].arclength, 0);
  EXPECT_EQ(three[1].arclength, 0.49);
  EXPECT_EQ(three[2].arclength, 1);
  EXPECT_EQ(evenly_spread(points, 7).size(), 7U);
  EXPECT_EQ(evenly_spread(points, 20).size(), 7U);
  EXPECT_EQ(evenly_spread(points, 6).back().arclength, 1);
}

}  // namespace
}  // namespace whirl::study
