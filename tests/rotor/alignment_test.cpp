// Rigid supports and alignment against closed forms of beams.

#include "whirl/rotor/alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "rotor/shafts.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/shaft.hpp"

using namespace whirl;

namespace {

constexpr double g = 9.81;

struct Uniform {
  rotor::Options options = test::uniform_shaft(2.0, 0.1, 8);
  rotor::Beam beam = rotor::make_beam(options.segments[0], options.material, options.shear);
  double q = beam.mass_per_length * g, ei = beam.bending_stiffness, length = 2.0;
  double shear = 12 * ei / (beam.shear_parameter * beam.length * beam.length);  // kappa G A
};

}  // namespace

TEST(RigidStatic, BeamOnTwoSupportsSagsAsInTheBooks) {
  const Uniform u;
  const auto s = rotor::rigid_static(MPI_COMM_WORLD, u.options, {{9, 0.0}, {1, 0.0}}, g);
  for (double r : s.reactions) EXPECT_NEAR(r / (u.q * u.length / 2), 1, 1e-9);
  EXPECT_NEAR(s.moment[4] / (u.q * u.length * u.length / 8), 1, 1e-9);
  EXPECT_NEAR(s.moment[2] / (u.q * 0.5 * 1.5 / 2), 1, 1e-9);
  EXPECT_NEAR(s.moment[0], 0, 1e-6);
  EXPECT_NEAR(s.moment[8], 0, 1e-6);
  const double l2 = u.length * u.length;
  EXPECT_NEAR(s.deflection[4] / -(5 * u.q * l2 * l2 / (384 * u.ei) + u.q * l2 / (8 * u.shear)), 1, 1e-9);
  EXPECT_LT(s.slope[1], 0);
  EXPECT_GT(s.slope[7], 0);
}

TEST(RigidStatic, MiddleSupportCarriesFiveEighthsAndItsElevationAddsTheStiffnessOfTheBeam) {
  Uniform u;
  u.options.shear = rotor::Shear::rigid;
  const auto level = rotor::rigid_static(MPI_COMM_WORLD, u.options, {{1, 0.0}, {5, 0.0}, {9, 0.0}}, g);
  EXPECT_NEAR(level.reactions[1] / (5 * u.q * u.length / 8), 1, 1e-9);
  EXPECT_NEAR(level.moment[4] / -(u.q * u.length * u.length / 32), 1, 1e-9);  // hogging
  const auto lifted = rotor::rigid_static(MPI_COMM_WORLD, u.options, {{1, 0.0}, {5, 1e-3}, {9, 0.0}}, g);
  EXPECT_NEAR((lifted.reactions[1] - level.reactions[1]) / (48 * u.ei * 1e-3 / std::pow(u.length, 3)), 1, 1e-8);
  EXPECT_NEAR(lifted.deflection[4], 1e-3, 1e-15);
}

TEST(RigidStatic, ReactionsBalanceWeightAndItsMomentWithDiscs) {
  const rotor::Options o = test::stepped_shaft();
  const auto s = rotor::rigid_static(MPI_COMM_WORLD, o, {{2, 1e-4}, {6, 0.0}, {12, -2e-4}}, g);
  EXPECT_NEAR(std::accumulate(s.reactions.begin(), s.reactions.end(), 0.0) / (rotor::total_mass(o) * g), 1, 1e-9);
}

TEST(Alignment, ZeroMomentOverTheMiddleSupportAndAGivenLoad) {
  const Uniform u;
  const std::vector<rotor::RigidSupport> supports{{1, 0.0}, {5, 7.0}, {9, 0.0}};
  auto elevations = rotor::align(MPI_COMM_WORLD, u.options, supports, {{2}, {5}, {}, {}}, g);
  // Without moment the halves are simple beams: the middle carries half of the whole weight.
  auto aligned = supports;
  aligned[1].elevation = elevations[1];
  const auto s = rotor::rigid_static(MPI_COMM_WORLD, u.options, aligned, g);
  EXPECT_NEAR(s.moment[4], 0, 1e-5);
  EXPECT_NEAR(s.reactions[1] / (u.q * u.length / 2), 1, 1e-8);
  EXPECT_EQ(elevations[0], 0);
  EXPECT_EQ(elevations[2], 0);
  elevations = rotor::align(MPI_COMM_WORLD, u.options, supports, {{2}, {}, {2}, {u.q * 0.7}}, g);
  aligned[1].elevation = elevations[1];
  EXPECT_NEAR(rotor::rigid_static(MPI_COMM_WORLD, u.options, aligned, g).reactions[1] / (u.q * 0.7), 1, 1e-8);
}

TEST(Alignment, WrongQuestionsAreRefused) {
  const Uniform u;
  const std::vector<rotor::RigidSupport> three{{1, 0.0}, {5, 0.0}, {9, 0.0}};
  const auto refused = [&](const std::vector<rotor::RigidSupport>& supports, const rotor::AlignmentRule& rule,
                           const std::string& text) {
    try {
      (void)rotor::align(MPI_COMM_WORLD, u.options, supports, rule, g);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const core::InputError& e) {
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
      EXPECT_TRUE(e.agreed());
    }
  };
  refused({{1, 0.0}}, {}, "at least two");
  refused({{1, 0.0}, {10, 0.0}}, {}, "support node 10");
  refused({{4, 0.0}, {4, 0.0}}, {}, "two supports at node 4");
  refused(three, {{2}, {}, {}, {}}, "1 elevations are sought from 0 conditions");
  refused(three, {{4}, {5}, {}, {}}, "support 4");
  refused(three, {{2}, {0}, {}, {}}, "moment node 0");
  refused(three, {{2}, {}, {2}, {}}, "one load");
  // Two supports are statically determinate: no elevation changes a load. All supports together only lift the shaft.
  refused({{1, 0.0}, {9, 0.0}}, {{2}, {}, {2}, {100.0}}, "do not determine");
  refused(three, {{1, 2, 3}, {5, 4}, {2}, {100.0}}, "do not determine");
}
