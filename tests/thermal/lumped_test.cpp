// One temperature for a film by its heat balance.
#include <gtest/gtest.h>

#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/thermal/lumped.hpp"

namespace whirl::thermal {
namespace {

Fluid oil() {
  Fluid out;
  out.viscosity = ConstantViscosity{0.02};
  out.density = 860;
  out.heat_capacity = 2000;
  out.conductivity = 0.125;
  return out;
}

// Pr = 0.02 2000/0.125 = 320, h = 1.5 0.125/1e-4 320^(1/3).
TEST(Lumped, WallTakesHeatByThePrandtlNumber) {
  EXPECT_NEAR(wall_coefficient(0.125, 1e-4, 320), 1875 * 6.839903786706787, 1e-9 * 1e4);
  EXPECT_NEAR(wall_coefficient(0.125, 1e-4, 8), 3750, 1e-9);
}

TEST(Lumped, GasIsRefused) {
  EXPECT_THROW((void)wall_coefficient(0.026, 2e-5, 0.7), core::DomainError);
  EXPECT_THROW((void)wall_coefficient(0.026, 2e-5, std::nan("")), core::DomainError);
  Fluid gas = oil();
  gas.conductivity = 10;
  const auto film = [](double) { return LumpedFilm{0.01, 300, 10}; };
  EXPECT_THROW((void)lumped_temperature(gas, 1e-4, {LumpedWall{1, 300}, {}}, film, 300), core::DomainError);
  EXPECT_NEAR(lumped_temperature(gas, 1e-4, {}, film, 300), 300.5, 1e-6);
}

// Constant properties: (c m T_i + Q + sum S h T_w)/(c m + sum S h).
TEST(Lumped, ConstantPropertiesHaveAClosedForm) {
  const double h = wall_coefficient(0.125, 1e-4, 320);
  const std::array<LumpedWall, 2> walls{LumpedWall{0.02, 330}, {0.01, 310}};
  const auto film = [](double) { return LumpedFilm{0.08, 313, 1500}; };
  const double exact = (160 * 313.0 + 1500 + 0.02 * h * 330 + 0.01 * h * 310) / (160 + 0.03 * h);
  EXPECT_NEAR(lumped_temperature(oil(), 1e-4, walls, film, 310), exact, 1e-6);
}

// Heat that falls with the temperature, Q = Q_0 exp(-b (T - T_i)): the rise x solves c m x = Q_0 exp(-b x).
TEST(Lumped, ThinnerOilHeatsLess) {
  const auto film = [](double t) { return LumpedFilm{0.05, 313, 2000 * std::exp(-0.03 * (t - 313))}; };
  const double rise = lumped_temperature(oil(), 1e-4, {}, film, 313) - 313;
  EXPECT_NEAR(100 * rise, 2000 * std::exp(-0.03 * rise), 1e-4);
  EXPECT_GT(rise, 10);
  EXPECT_LT(rise, 20);
}

TEST(Lumped, HeatWithoutFlowIsNotInBalance) {
  const auto film = [](double) { return LumpedFilm{0, 313, 1}; };
  EXPECT_THROW((void)lumped_temperature(oil(), 1e-4, {}, film, 313), core::NotConverged);
}

}  // namespace
}  // namespace whirl::thermal
