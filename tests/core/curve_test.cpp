// Tables between their rows.

#include "whirl/core/curve.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "whirl/core/error.hpp"

using whirl::core::Curve;

namespace {

using Two = std::array<double, 2>;

struct At {
  Two value{}, slope{};
};

At at(const Curve& c, double x) {
  At out;
  c.at(x, out.value, out.slope);
  return out;
}

const std::vector<double> places{1, 2, 4, 5, 9};
const std::vector<double> rows{0, 3, 1, 3, 5, 2, 5, 4, 6, -1};  // rises; falls, turns and falls

}  // namespace

TEST(Curve, MeetsItsRowsAndItsSlopeIsThatOfItsValues) {
  for (const auto between : {Curve::Between::cubic, Curve::Between::linear}) {
    const Curve c(places, rows, between);
    for (std::size_t k = 0; k < places.size(); ++k)
      for (std::size_t e = 0; e < 2; ++e) EXPECT_NEAR(at(c, places[k]).value[e], rows[2 * k + e], 1e-14);
    for (double x = 1.05; x < 9; x += 0.1) {
      constexpr double h = 1e-6;
      const Two above = at(c, x + h).value, below = at(c, x - h).value;
      for (std::size_t e = 0; e < 2; ++e) EXPECT_NEAR(at(c, x).slope[e], (above[e] - below[e]) / (2 * h), 1e-8) << x;
    }
  }
}

TEST(Curve, DoesNotOvershoot) {
  const Curve c(places, rows, Curve::Between::cubic);
  double last = -1;
  for (double x = 1; x <= 9; x += 0.01) {
    const Two value = at(c, x).value;
    EXPECT_GE(value[0], last);
    EXPECT_LE(value[1], 4);
    EXPECT_GE(value[1], -1);
    last = value[0];
  }
}

TEST(Curve, HoldsBeyondItsRows) {
  for (const auto between : {Curve::Between::cubic, Curve::Between::linear}) {
    const Curve c(places, rows, between), one({3}, {7, 8}, between);
    EXPECT_EQ(at(c, 0).value, (Two{0, 3}));
    EXPECT_EQ(at(c, 99).value, (Two{6, -1}));
    EXPECT_EQ(at(c, 99).slope, (Two{0, 0}));
    for (const double x : {0.0, 3.0, 9.0}) EXPECT_EQ(at(one, x).value, (Two{7, 8}));
    EXPECT_FALSE(one.varies());
  }
  EXPECT_THROW(Curve({1, 1}, {0, 0}, Curve::Between::linear), whirl::core::InputError);
}
