// Bearings known by coefficients over the speed.
#include "whirl/film/contract/linear.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film::testing {
namespace {

const JournalMotion moving{{3e-6, -2e-6, 0, 0}, {4e-3, 1e-3, 0, 0}, 0};

Response at(Film& film, double speed) {
  JournalMotion m = moving;
  m.speed = speed;
  Response out;
  film.evaluate(m, Need::tangents, out);
  return out;
}

// -dF/dx and -dF/dx' at a speed.
double k_xx(const Linear& o, double speed) {
  const auto film = make({}, o, {});
  return -at(*film, speed).d_position[0][0];
}

// By hand half-way between two rows, added to what is constant.
TEST(Linear, BetweenTwoSpeeds) {
  Linear o;
  o.stiffness = {1e6, 0, 0, 2e6};
  o.damping = {10, 0, 0, 20};
  o.table = {{100, 1e7, 2e6, -3e6, 4e7, 1e3, 2e2, -3e2, 4e3}, {300, 3e7, 4e6, -7e6, 8e7, 3e3, 0, -5e2, 2e3}};
  const auto film = make({}, o, {});
  const Response r = at(*film, 200);
  const std::array<double, 4> k = {2.1e7, 3e6, -5e6, 6.2e7}, c = {2010, 100, -400, 3020};
  for (std::size_t i = 0; i < 2; ++i) {
    double force = 0;
    for (std::size_t j = 0; j < 2; ++j) {
      EXPECT_NEAR(-r.d_position[i][j], k[2 * i + j], 1e-12 * 6e7);
      EXPECT_NEAR(-r.d_velocity[i][j], c[2 * i + j], 1e-12 * 3e3);
      force -= k[2 * i + j] * moving.position[j] + c[2 * i + j] * moving.velocity[j];
    }
    EXPECT_NEAR(r.force[i], force, 1e-12 * 100);
  }
  // By the speed: what both rows differ by in 200 rad/s.
  EXPECT_NEAR(r.d_speed[0], -(2e7 * 3e-6 + 2e6 * -2e-6 + 2e3 * 4e-3 - 200 * 1e-3) / 200, 1e-12);
  EXPECT_NEAR(r.d_speed[1], -(-4e6 * 3e-6 + 4e7 * -2e-6 - 200 * 4e-3 - 2e3 * 1e-3) / 200, 1e-12);
}

// Rows are met, between them nothing overshoots, and the slope is continuous; the derivative is that of the force.
TEST(Linear, OverManySpeeds) {
  Linear o;
  const std::array<double, 6> speed = {0, 100, 150, 400, 450, 900}, k = {1e7, 1.1e7, 3e7, 3.2e7, 2e7, 2e7};
  for (std::size_t i = 0; i < speed.size(); ++i) o.table.push_back({.speed = speed[i], .k_xx = k[i], .k_yy = 1e7});
  const auto film = make({}, o, {});
  for (std::size_t i = 0; i < speed.size(); ++i) EXPECT_NEAR(k_xx(o, speed[i]), k[i], 1e-8);
  for (std::size_t i = 1; i < speed.size(); ++i)
    for (const double part : {0.1, 0.5, 0.9}) {
      const double w = speed[i - 1] + part * (speed[i] - speed[i - 1]), found = k_xx(o, w);
      EXPECT_GE(found, std::min(k[i - 1], k[i]) - 1e-6) << w;
      EXPECT_LE(found, std::max(k[i - 1], k[i]) + 1e-6) << w;
      const double step = 0.01;
      const double by_differences = (at(*film, w + step).force[0] - at(*film, w - step).force[0]) / (2 * step);
      EXPECT_NEAR(at(*film, w).d_speed[0], by_differences, 1e-5) << w;
    }
  for (std::size_t i = 1; i + 1 < speed.size(); ++i)
    EXPECT_NEAR(at(*film, speed[i] - 1e-6).d_speed[0], at(*film, speed[i] + 1e-6).d_speed[0], 1e-6) << speed[i];
}

// A smooth curve: the error falls with the third power of the distance of the rows or faster.
TEST(Linear, ConvergesWithTheRows) {
  const auto exact = [](double w) { return 1e7 * std::exp(w / 500); };
  std::array<double, 2> error{};
  for (std::size_t n = 0; n < 2; ++n) {
    Linear o;
    const int rows = n == 0 ? 8 : 16;
    for (int i = 0; i <= rows; ++i) {
      const double w = 1000.0 * i / rows;
      o.table.push_back({.speed = w, .k_xx = exact(w), .k_yy = 1e7});
    }
    for (double w = 5; w < 1000; w += 10) error[n] = std::max(error[n], std::abs(k_xx(o, w) / exact(w) - 1));
  }
  EXPECT_LT(error[1], 1e-3);
  EXPECT_GT(error[1], 0);
  EXPECT_GT(std::log2(error[0] / error[1]), 2.6);
}

TEST(Linear, IsUnknownBeyondItsTable) {
  Linear o;
  o.table = {{.speed = 100, .k_xx = 1e7, .k_yy = 1e7}};
  EXPECT_EQ(k_xx(o, 5000), 1e7);  // one row says the same of all speeds
  o.table.push_back({.speed = 300, .k_xx = 3e7, .k_yy = 1e7});
  EXPECT_EQ(k_xx(o, 300 * (1 + 1e-14)), 3e7);
  EXPECT_THROW((void)k_xx(o, 99), core::DomainError);
  EXPECT_THROW((void)k_xx(o, 301), core::DomainError);
  o.table.push_back({.speed = 300, .k_xx = 3e7, .k_yy = 1e7});
  EXPECT_THROW((void)make({}, o, {}), core::InputError);
}

}  // namespace
}  // namespace whirl::film::testing
