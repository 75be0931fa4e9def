// Undamped critical speeds: a rigid shaft, a pinned one, and one that an independent computation knows.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/rotor/critical_speeds.hpp"
#include "whirl/rotor/frequencies.hpp"
#include "whirl/rotor/shaft.hpp"

using namespace whirl;
using rotor::Whirl;

namespace {

constexpr double length = 0.3, diameter = 0.015, density = 7860, modulus = 205e9;

rotor::Options shaft(int elements) {
  rotor::Options o;
  o.material.density = density;
  o.material.modulus = {{293.15, modulus}};
  for (int k = 0; k < elements; ++k) {
    rotor::Segment s;
    s.length = length / elements;
    s.rotor = "A";
    s.outer_mass_diameter = diameter;
    o.segments.push_back(s);
  }
  return o;
}

// On soft springs: bounce and pitch of a rigid cylinder, whose inertias are those of the section and of the length.
TEST(CriticalSpeeds, OfARigidCylinderOnSoftSprings) {
  const rotor::Options o = shaft(20);
  const double k = 1.0, mass = rotor::total_mass(o), radius2 = diameter * diameter / 4;
  const double polar = 0.5 * mass * radius2, across = mass * (length * length / 12 + radius2 / 4);
  for (const auto& [whirl, sign] : {std::pair{Whirl::forward, -1}, {Whirl::backward, 1}}) {
    const auto found = rotor::critical_speeds(o, {{1}, {21}}, k, whirl, 2);
    ASSERT_EQ(found.size(), 2U);
    EXPECT_NEAR(found[0], std::sqrt(2 * k / mass), 1e-5 * found[0]);
    EXPECT_NEAR(found[1], std::sqrt(2 * k * length * length / 4 / (across + sign * polar)), 1e-5 * found[1]);
  }
}

// On stiff springs the mean of the squares' inverses is that of the shaft at rest: (1/f^2 + 1/b^2)/2 = 1/omega^2 to
// first order in the gyroscopic part.
TEST(CriticalSpeeds, OfAPinnedShaft) {
  const rotor::Options o = shaft(20);
  const auto at_rest = rotor::natural_frequencies(MPI_COMM_SELF, o, {1, 21}, 2);
  const auto forward = rotor::critical_speeds(o, {{1}, {21}}, 1e15, Whirl::forward, 2),
             backward = rotor::critical_speeds(o, {{1}, {21}}, 1e15, Whirl::backward, 2);
  for (std::size_t k = 0; k < 2; ++k) {
    const double mean = 0.5 * (1 / (forward[k] * forward[k]) + 1 / (backward[k] * backward[k]));
    EXPECT_GT(forward[k], backward[k]);
    EXPECT_NEAR(1 / std::sqrt(mean), at_rest[k], 1e-4 * at_rest[k]);
  }
}

TEST(CriticalSpeeds, OfADiscThatCannotWhirlForward) {
  rotor::Options o = shaft(20);
  rotor::Disc disc;
  disc.node = 11;
  disc.mass = 0.01;
  disc.diametral_inertia = 1e-2;
  disc.polar_inertia = 2e-2;
  o.discs = {disc};
  const auto forward = rotor::critical_speeds(o, {{1}, {21}}, 1e7, Whirl::forward, 100),
             backward = rotor::critical_speeds(o, {{1}, {21}}, 1e7, Whirl::backward, 100);
  EXPECT_EQ(backward.size(), 42U);
  EXPECT_LT(forward.size(), rotor::critical_speeds(shaft(20), {{1}, {21}}, 1e7, Whirl::forward, 100).size());
  EXPECT_LT(backward[0], 0.5 * forward[0]);
}

// Bounce of half a rigid cylinder on a spring k above a mass m on a spring s: the roots of
// (k - M w^2)(k + s - m w^2) = k^2.
TEST(CriticalSpeeds, OfARigidCylinderOnStands) {
  const rotor::Options o = shaft(20);
  const double k = 1.0, half = rotor::total_mass(o) / 2;
  const auto bounce = [&](double m, double s) {
    const double b = k * m + (k + s) * half, root = std::sqrt(b * b - 4 * half * m * k * s);
    return std::array{std::sqrt((b - root) / (2 * half * m)), std::sqrt((b + root) / (2 * half * m))};
  };
  const auto has = [](const std::vector<double>& all, double wanted) {
    return std::any_of(all.begin(), all.end(), [&](double v) { return std::abs(v - wanted) < 1e-5 * wanted; });
  };
  const rotor::Stand equal{{0.3, 0.3}, {2, 2}}, other{{0.3, 0.2}, {2, 5}};
  for (const Whirl whirl : {Whirl::forward, Whirl::backward}) {
    const auto found = rotor::critical_speeds(o, {{1, 0}, {21, 1}}, k, whirl, 4, {equal, equal});
    for (const double wanted : bounce(0.3, 2)) EXPECT_TRUE(has(found, wanted)) << wanted;
  }
  // Each plane for itself, as nothing turns: motion on a line counts as forward.
  const auto planes = rotor::critical_speeds(o, {{1, 0}, {21, 1}}, k, Whirl::forward, 8, {other, other});
  for (const double wanted : bounce(0.3, 2)) EXPECT_TRUE(has(planes, wanted)) << wanted;
  for (const double wanted : bounce(0.2, 5)) EXPECT_TRUE(has(planes, wanted)) << wanted;
  // Beside one stand that differs by nothing the map of both planes is that of one.
  rotor::Stand nearly = equal;
  nearly.stiffness[1] *= 1 + 1e-9;
  for (const Whirl whirl : {Whirl::forward, Whirl::backward}) {
    const auto one = rotor::critical_speeds(o, {{1, 0}, {21}}, 1e6, whirl, 3, {equal}),
               both = rotor::critical_speeds(o, {{1, 0}, {21}}, 1e6, whirl, 3, {nearly});
    ASSERT_EQ(one.size(), both.size());
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(one[i], both[i], 1e-6 * one[i]);
  }
}

TEST(CriticalSpeeds, RefuseWhatDoesNotHold) {
  EXPECT_THROW((void)rotor::critical_speeds(shaft(4), {{1}}, 1e7, Whirl::forward, 2), core::InputError);
  EXPECT_THROW((void)rotor::critical_speeds(shaft(4), {{1}, {9}}, 1e7, Whirl::forward, 2), core::InputError);
  EXPECT_THROW((void)rotor::critical_speeds(shaft(4), {{1}, {5}}, 0, Whirl::forward, 2), core::InputError);
}

}  // namespace
