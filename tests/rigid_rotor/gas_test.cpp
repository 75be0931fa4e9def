// A rigid rotor on a film of gas with states of its own, from its deck.
#include <gtest/gtest.h>

#include <cmath>

#include "rigid_rotor/run_deck.hpp"
#include "source_dir.hpp"

namespace {

using namespace whirl;

// Place, stiffness and damping of bearing A at 0.6 MPa, 2000 rad/s and 49.05 N by an independent computation on 192 x
// 64 cells, whose first axis points against the load.
TEST(Aerostatic, BearingACarriesItsRotor) {
  study::Deck deck = study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/aerostatic/bearing_a.yaml",
                                 {"bearings.A.film.cells=[48, 16]", "studies=[{static: {speed: 2000 rad/s}}]"});
  const auto v = test::values_of(test::run_deck(deck, "aerostatic").at(0));
  EXPECT_NEAR(v.at("bearing.A.force.y"), 49.05, 1e-4);
  EXPECT_NEAR(v.at("bearing.A.y"), -6.09993e-6, 0.01 * 6.1e-6);
  EXPECT_NEAR(v.at("bearing.A.x"), 0.71965e-6, 0.01 * 6.1e-6);
  EXPECT_NEAR(v.at("bearing.A.K.yy"), 8.45395e6, 0.01 * 8.45e6);
  EXPECT_NEAR(v.at("bearing.A.K.xx"), 8.37639e6, 0.01 * 8.45e6);
  EXPECT_NEAR(v.at("bearing.A.K.xy"), 0.89885e6, 0.01 * 8.45e6);
  EXPECT_NEAR(v.at("bearing.A.K.yx"), -0.66339e6, 0.01 * 8.45e6);
  EXPECT_NEAR(v.at("bearing.A.C.yy"), 1185.2, 0.01 * 1185.2);
  EXPECT_NEAR(v.at("bearing.A.C.xx"), 825.5, 0.01 * 1185.2);
  EXPECT_NEAR(v.at("bearing.A.normal_flow"), v.at("bearing.A.mass_flow") / 1.2929 * 6e4, 1e-9);
  EXPECT_GT(v.at("bearing.A.mass_flow"), 1.5e-4);
  EXPECT_NEAR(v.at("bearing.A.drag_torque") * 2000.0, v.at("bearing.A.power_loss"), 1e-9);
}

}  // namespace
