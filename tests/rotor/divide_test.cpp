// A shaft whose segments are cut is the same shaft.
#include "whirl/rotor/divide.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rotor/shafts.hpp"
#include "whirl/rotor/shaft.hpp"

using namespace whirl;

TEST(Divide, KeepsMassPlacesAndTaper) {
  rotor::Options shaft = test::stepped_shaft();
  shaft.segments[1].right_outer_diameter = 0.05;
  shaft.reduction.masters = {1, 13};
  const rotor::Options cut = rotor::divided(shaft, 3);
  EXPECT_NEAR(rotor::total_mass(cut), rotor::total_mass(shaft), 1e-12 * rotor::total_mass(shaft));
  const auto places = rotor::node_positions(shaft), finer = rotor::node_positions(cut);
  ASSERT_EQ(finer.size(), 3 * (places.size() - 1) + 1);
  for (int node = 1; node <= rotor::n_nodes(shaft); ++node)
    EXPECT_NEAR(finer[static_cast<std::size_t>(rotor::node_after(shaft, node, 3) - 1)],
                places[static_cast<std::size_t>(node - 1)], 1e-14);
  EXPECT_EQ(cut.discs[0].node, 31);
  EXPECT_EQ(cut.reduction.masters, (std::vector<int>{1, 37}));
  for (std::size_t k = 3; k < 6; ++k) EXPECT_TRUE(rotor::tapered(cut.segments[k]));
  EXPECT_DOUBLE_EQ(*cut.segments[3].right_outer_diameter, cut.segments[4].outer_mass_diameter);
  EXPECT_DOUBLE_EQ(*cut.segments[5].right_outer_diameter, 0.05);
}

// Two rigid halves and a joint have no length of their own to cut.
TEST(Divide, LeavesCouplingsWhole) {
  rotor::Options shaft = test::uniform_shaft(0.3, 0.015, 4);
  shaft.couplings = {{.segment = 3, .stiffness = 1e7, .tilt_stiffness = 1e3}};
  const rotor::Options cut = rotor::divided(shaft, 2);
  ASSERT_EQ(cut.segments.size(), 7U);
  EXPECT_EQ(cut.couplings[0].segment, 5);
  EXPECT_EQ(cut.segments[4].length, shaft.segments[2].length);
  EXPECT_NEAR(rotor::total_mass(cut), rotor::total_mass(shaft), 1e-12 * rotor::total_mass(shaft));
  const auto places = rotor::node_positions(shaft), finer = rotor::node_positions(cut);
  for (int node = 1; node <= rotor::n_nodes(shaft); ++node)
    EXPECT_NEAR(finer[static_cast<std::size_t>(rotor::node_after(shaft, node, 2) - 1)],
                places[static_cast<std::size_t>(node - 1)], 1e-14);
  // Its whirl is that of more beams beside the same coupling.
  const auto ends = [](int last) { return std::vector<test::IsotropicBearing>{{1, 1e7}, {last, 1e7}}; };
  const auto coarse = test::whirl_modes(shaft, ends(5), 500), fine = test::whirl_modes(cut, ends(8), 500),
             finest = test::whirl_modes(rotor::divided(shaft, 8), ends(26), 500);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_LT(std::abs(fine[k].frequency - finest[k].frequency), std::abs(coarse[k].frequency - finest[k].frequency));
}

// The whirl of 4 elements cut into 3 is that of 12.
TEST(Divide, WhirlsLikeTheFinerShaft) {
  const std::vector<test::IsotropicBearing> ends{{1, 1e7}, {13, 1e7}};
  const auto cut = test::whirl_modes(rotor::divided(test::uniform_shaft(0.3, 0.015, 4), 3), ends, 5000),
             fine = test::whirl_modes(test::uniform_shaft(0.3, 0.015, 12), ends, 5000);
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(cut[k].frequency, fine[k].frequency, 1e-7 * std::abs(fine[k].frequency));
}
