// Discs whose centre of mass is off their node, and discs that lean as the shaft is deflected.

#include <gtest/gtest.h>

#include <cmath>

#include "rotor/shafts.hpp"
#include "support/dense.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/frequencies.hpp"
#include "whirl/rotor/rotor.hpp"
#include "whirl/rotor/shaft.hpp"

using namespace whirl;

namespace {

rotor::Disc thick_disc(int node) {
  rotor::Disc d;
  d.node = node;
  d.mass = 8;
  d.polar_inertia = 0.06;
  d.diametral_inertia = 0.04;
  return d;
}

}  // namespace

// Half the offset in front of its node a disc is what it is on an arm without mass that does not bend.
TEST(Disc, OffsetIsARigidArmWithoutMass) {
  const std::vector<test::IsotropicBearing> bearings{{1, 3e7}, {9, 5e7}};
  const double offset = 0.04;
  rotor::Options by_offset = test::uniform_shaft(0.6, 0.05, 12), by_arm = by_offset;
  rotor::Disc d = thick_disc(13);
  d.offset = offset;
  by_offset.discs = {d};
  rotor::Segment arm = by_arm.segments.back();
  arm.length = offset;
  arm.outer_stiffness_diameter = 2;  // 40 times that of the shaft
  arm.outer_mass_diameter = 1e-6;
  by_arm.segments.push_back(arm);
  by_arm.discs = {thick_disc(14)};
  const auto a = test::whirl_modes(by_offset, bearings, 800), b = test::whirl_modes(by_arm, bearings, 800);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(a[k].frequency / b[k].frequency, 1, 2e-6) << k;
  // On the other side it is another rotor.
  by_offset.discs[0].offset = -offset;
  EXPECT_GT(std::abs(test::whirl_modes(by_offset, bearings, 800)[0].frequency / b[0].frequency - 1), 1e-2);
}

// Rigid motions see the inertia of the disc where its centre is, whatever it leans with.
TEST(Disc, RigidMotionsSeeItsInertiaAtItsCentre) {
  for (const bool hub : {false, true}) {
    rotor::Options o = test::uniform_shaft(0.6, 0.05, 12);
    const rotor::Rotor bare(MPI_COMM_WORLD, o);
    rotor::Disc d = thick_disc(4);
    d.offset = -0.02;
    if (hub) d.hub = {3, 6};
    o.discs = {d};
    const rotor::Rotor r(MPI_COMM_WORLD, o);
    const auto added = [&](const core::Matrix rotor::Matrices::*of) {
      return Eigen::MatrixXd(test::dense((r.matrices().*of).get()) - test::dense((bare.matrices().*of).get()));
    };
    const std::vector<double> z = rotor::node_positions(o);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(4 * 13), tilt = x, tilt_y = x;
    for (Eigen::Index k = 0; k < 13; ++k) {
      x(4 * k) = 1;
      tilt(4 * k) = tilt_y(4 * k + 1) = z[static_cast<std::size_t>(k)];
      tilt(4 * k + 2) = tilt_y(4 * k + 3) = 1;
    }
    const double centre = z[3] + d.offset;
    EXPECT_NEAR(x.dot(added(&rotor::Matrices::mass) * x), 8, 1e-12);
    EXPECT_NEAR(x.dot(added(&rotor::Matrices::mass) * tilt), 8 * centre, 1e-12);
    EXPECT_NEAR(tilt.dot(added(&rotor::Matrices::mass) * tilt), 8 * centre * centre + 0.04, 1e-12);
    EXPECT_NEAR(tilt.dot(added(&rotor::Matrices::gyroscopic) * tilt_y), 0.06, 1e-12);
    EXPECT_EQ(added(&rotor::Matrices::stiffness).norm(), 0);
    const Eigen::VectorXd weight = test::dense(r.matrices().gravity.get()) - test::dense(bare.matrices().gravity.get());
    EXPECT_NEAR(tilt_y.dot(weight), -8 * centre, 1e-12);
  }
}

// With the hub given in metres, frequencies converge: the section's tilt and the mean slope of the deflection are two
// models, which differ by the shear of the shaft below the hub.
TEST(Disc, OnAHubFrequenciesConvergeToAnotherModel) {
  const auto lowest = [](rotor::BeamElement element, int fine, bool hub) {
    rotor::Options o = test::uniform_shaft(0.6, 0.06, 12 * fine);
    o.element = element;
    o.discs = {thick_disc(3 * fine + 1)};
    if (hub) o.discs[0].hub = {2 * fine + 1, 4 * fine + 1};
    return rotor::natural_frequencies(MPI_COMM_WORLD, o, {1, 12 * fine + 1}, 4);
  };
  using enum rotor::BeamElement;
  for (const auto element : {timoshenko_linear, timoshenko_hermitian}) {
    const auto section = lowest(element, 4, false), coarse = lowest(element, 2, true), fine = lowest(element, 4, true);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(coarse[k] / fine[k], 1, 2e-5) << k;
    EXPECT_LT(std::abs(fine[0] / section[0] - 1), 1e-3);
    EXPECT_GT(std::abs(fine[1] / section[1] - 1), 1e-3);
  }
  // Both families have the same limit.
  EXPECT_NEAR(lowest(timoshenko_linear, 4, true)[3] / lowest(timoshenko_hermitian, 4, true)[3], 1, 2e-5);
}

TEST(Disc, AHubThatDoesNotHoldItIsRefused) {
  rotor::Options o = test::uniform_shaft(0.6, 0.05, 12);
  for (const std::vector<int>& hub : {std::vector<int>{5, 6}, {4}, {4, 4}, {5, 3}, {3, 14}}) {
    rotor::Disc d = thick_disc(4);
    d.hub = hub;
    o.discs = {d};
    EXPECT_THROW(rotor::validate(o), core::InputError);
  }
}
