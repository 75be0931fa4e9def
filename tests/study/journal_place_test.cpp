// The place of a journal under a load, by itself.
#include "study/bearing/journal_place.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "whirl/core/error.hpp"

namespace {

using namespace whirl;

constexpr double clearance = 100e-6, viscosity = 0.02, speed = 300;

std::unique_ptr<film::Film> short_film() {
  return film::make_film({film::Geometry::Bore::cylindrical, 0.05, 0.025, clearance, 0.0, 0.0, 0.0}, film::Short{},
                         {viscosity, 860});
}

// Ocvirk's half film: load and attitude of a short bearing are known in closed form at every eccentricity.
TEST(JournalPlace, OfAShortBearing) {
  const auto film = short_film();
  for (const double e : {0.1, 0.5, 0.9}) {
    const double q = 1 - e * e, unit = viscosity * speed * 0.05 * std::pow(0.025, 3) / (4 * clearance * clearance);
    const double load = unit * e / (q * q) * std::sqrt(16 * e * e + std::numbers::pi * std::numbers::pi * q);
    study::JournalPlace start;
    start.motion.speed = speed;
    const study::JournalPlace at = study::carry(*film, clearance, {0, -load}, start);
    EXPECT_NEAR(at.force[1], load, 1e-8 * load);
    const auto& x = at.motion.position;
    EXPECT_NEAR(std::hypot(x[0], x[1]) / clearance, e, 1e-7);
    EXPECT_NEAR(std::atan2(x[0], -x[1]), std::atan(std::numbers::pi * std::sqrt(q) / (4 * e)), 1e-7);
  }
}

// A film of gas fed by orifices carries no more than its supply.
TEST(JournalPlace, BeyondTheCapacity) {
  film::Gas gas;
  gas.cells = {32, 8};
  gas.orifices.push_back({8, 0.0, 0.0, 0.2e-3, 3e5});
  const auto film =
      film::make_film({film::Geometry::Bore::cylindrical, 0.015, 0.03, 20e-6, 0.0, 0.0, 0.0}, gas, {1.846e-5, 1.18});
  study::JournalPlace start;
  start.motion.speed = 200;
  try {
    (void)study::carry(*film, 20e-6, {0, -500}, start);
    FAIL() << "180 N is all that the supply could press on the journal";
  } catch (const core::NotConverged& e) {
    EXPECT_NE(std::string(e.what()).find("no equilibrium"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("carries"), std::string::npos);
  }
}

}  // namespace
