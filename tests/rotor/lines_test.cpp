// Torsional and axial modes against bars with exact frequencies.

#include "whirl/rotor/lines.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rotor/shafts.hpp"
#include "whirl/core/error.hpp"

using namespace whirl;
using rotor::Line;
using std::numbers::pi;

namespace {

constexpr double length = 0.8, e = 2.1e11, density = 7850;

double wave_speed(Line line) {
  return std::sqrt((line == Line::axial ? e : e / 2.6) / density);
}

}  // namespace

// Free-free: k pi c/L; held at one end: (k - 1/2) pi c/L. From above, with order two.
TEST(Lines, UniformBarConvergesToItsWaves) {
  for (const Line line : {Line::torsion, Line::axial})
    for (const bool held : {false, true}) {
      std::vector<std::vector<double>> error;
      for (const int n : {10, 20, 40}) {
        const auto found = rotor::line_modes(test::uniform_shaft(length, 0.05, n, e, density, 0.02), line,
                                             held ? std::vector<int>{1} : std::vector<int>{}, 3);
        ASSERT_EQ(found.frequencies.size(), 3u);
        error.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
          const double half_waves = static_cast<double>(k) + (held ? 0.5 : 1);
          error.back().push_back(found.frequencies[k] / (half_waves * pi * wave_speed(line) / length) - 1);
          EXPECT_GT(error.back()[k], 0);
        }
      }
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(std::log2(error[0][k] / error[1][k]), 2, 0.05);
        EXPECT_NEAR(std::log2(error[1][k] / error[2][k]), 2, 0.02);
      }
    }
}

// A cone held at both ends: with the diameter d and the displacement u, d u is a wave of a uniform bar.
TEST(Lines, ConeHeldAtBothEndsHasTheWavesOfABar) {
  std::vector<double> error;
  for (const int n : {10, 20}) {
    rotor::Options o = test::uniform_shaft(length, 0.05, n, e, density);
    for (int k = 0; k < n; ++k) {
      o.segments[static_cast<std::size_t>(k)].outer_mass_diameter = 0.05 + 0.05 * k / n;
      o.segments[static_cast<std::size_t>(k)].right_outer_diameter = 0.05 + 0.05 * (k + 1) / n;
    }
    const auto found = rotor::line_modes(o, Line::axial, {1, n + 1}, 1);
    error.push_back(found.frequencies[0] / (pi * wave_speed(Line::axial) / length) - 1);
    EXPECT_NEAR(found.shapes[0].front(), 0, 1e-15);
  }
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.05);
}

// Two discs on a shaft or a coupling without inertia: omega^2 = k (1/I_1 + 1/I_2).
TEST(Lines, TwoDiscsOnASpring) {
  rotor::Options o = test::uniform_shaft(length, 0.05, 1, e, 1e-6);
  rotor::Disc d;
  d.node = 1;
  d.mass = 10;
  d.polar_inertia = 0.3;
  o.discs = {d, d};
  o.discs[1].node = 2;
  o.discs[1].mass = 4;
  o.discs[1].polar_inertia = 0.7;
  const double twist = e / 2.6 * pi / 32 * std::pow(0.05, 4) / length, stretch = e * pi / 4 * 0.05 * 0.05 / length;
  const auto one = [&](Line line) { return rotor::line_modes(o, line, {}, 5).frequencies.at(0); };
  EXPECT_NEAR(one(Line::torsion) / std::sqrt(twist * (1 / 0.3 + 1 / 0.7)), 1, 1e-8);
  EXPECT_NEAR(one(Line::axial) / std::sqrt(stretch * (1.0 / 10 + 1.0 / 4)), 1, 1e-8);
  rotor::Coupling c;
  c.segment = 1;
  c.stiffness = 1e6;
  c.torsional_stiffness = 5e4;
  o.couplings = {c};
  EXPECT_NEAR(one(Line::torsion) / std::sqrt(5e4 * (1 / 0.3 + 1 / 0.7)), 1, 1e-8);
  EXPECT_THROW((void)one(Line::axial), core::InputError);
}
