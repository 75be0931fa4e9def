// Whirl frequencies of spinning shafts against published values, and the exact Timoshenko beam.

#include <gtest/gtest.h>

#include <algorithm>

#include <cmath>
#include <numbers>

#include "reference/rotor/published.hpp"
#include "rotor/shafts.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/frequencies.hpp"

using namespace whirl;
namespace ref = whirl::reference::rotors;
using std::numbers::pi;

namespace {

rotor::Disc disc(int node, double outer) {
  rotor::Disc d;
  d.node = node;
  d.outer_diameter = outer;
  d.inner_diameter = 0.05;
  d.thickness = 0.07;
  return d;
}

rotor::Options friswell_shaft() {
  rotor::Options o = test::uniform_shaft(1.5, 0.05, 6, 2.11e11, 7810);
  o.material.shear_modulus = 8.12e10;
  o.material.poisson = 2.11e11 / (2 * 8.12e10) - 1;
  return o;
}

// To one unit of the last printed digit.
template <std::size_t N>
void expect_magnitudes(const std::vector<test::Whirl>& found, const std::array<double, N>& wanted) {
  for (std::size_t i = 0; i < N; ++i)
    EXPECT_NEAR(std::abs(found[i].frequency), wanted[i], wanted[i] > 1000 ? 0.1 : 0.01) << i;
}

// omega of mode n of the pinned Timoshenko beam: E I b^4 - m w^2 - (j + E I m/S) b^2 w^2 + (j m/S) w^4 = 0 with b = n
// pi/L and S = kappa G A the shear stiffness; the lower root is the bending branch.
double timoshenko_pinned(int n, double length, double ei, double m, double j, double shear) {
  const double b2 = std::pow(n * pi / length, 2);
  const double a = j * m / shear, b = -(m + (j + ei * m / shear) * b2), c = ei * b2 * b2;
  return std::sqrt(2 * c / (-b + std::sqrt(b * b - 4 * a * c)));
}

}  // namespace

TEST(Friswell, Example591) {
  rotor::Options o = friswell_shaft();
  o.discs = {disc(3, 0.28), disc(5, 0.35)};
  const std::vector<test::IsotropicBearing> bearings{{1, 1e6}, {7, 1e6}};
  expect_magnitudes(test::whirl_modes(o, bearings, 0), ref::friswell_591_rest);
  const auto spinning = test::whirl_modes(o, bearings, 4000 * pi / 30);
  expect_magnitudes(spinning, ref::friswell_591_4000_rpm);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(spinning[i].frequency > 0, i % 2 == 1) << "backward first, then forward";
}

TEST(Friswell, Example599Overhung) {
  rotor::Options o = friswell_shaft();
  o.discs = {disc(7, 0.35)};
  const std::vector<test::IsotropicBearing> bearings{{1, 1e7}, {5, 1e7}};
  expect_magnitudes(test::whirl_modes(o, bearings, 0), ref::friswell_599_rest);
  const auto spinning = test::whirl_modes(o, bearings, 4000 * pi / 30);
  expect_magnitudes(spinning, ref::friswell_599_4000_rpm);
  EXPECT_LT(spinning[0].frequency, 0);
  EXPECT_GT(spinning[1].frequency, 0);
}

TEST(TrialRotor, RayleighAndTimoshenkoWithAndWithoutDisc) {
  const auto shaft = [](int elements, rotor::Shear shear, bool with_disc) {
    rotor::Options o = test::uniform_shaft(0.3, 0.015, elements, 2.05e11, 7860);
    o.shear = shear;
    rotor::Disc d;
    d.node = 1 + 3 * elements / 10;
    d.mass = 0.5;
    d.diametral_inertia = 7.81e-5;
    d.polar_inertia = 1.56e-4;
    if (with_disc) o.discs = {d};
    return o;
  };
  const auto modes = [](const rotor::Options& o, double speed) {
    return test::whirl_modes(o, {{1, 1e7}, {static_cast<int>(o.segments.size()) + 1, 1e7}}, speed);
  };
  // One element has one shear angle: frequencies converge with h^2, so two meshes are extrapolated. Rayleigh: h^4.
  const auto expect_timoshenko = [&](bool with_disc, const auto& wanted) {
    const auto coarse = modes(shaft(30, rotor::Shear::cowper_solid, with_disc), ref::trial_spin);
    const auto fine = modes(shaft(60, rotor::Shear::cowper_solid, with_disc), ref::trial_spin);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_NEAR((4 * fine[i].frequency - coarse[i].frequency) / 3 / wanted[i], 1, 5e-6) << i;
      EXPECT_NEAR(fine[i].frequency / wanted[i], 1, 5e-4) << i;
    }
  };
  expect_timoshenko(false, ref::trial_timoshenko_spinning);
  expect_timoshenko(true, ref::disc_timoshenko_spinning);
  const auto rayleigh = modes(shaft(60, rotor::Shear::rigid, false), ref::trial_spin);
  for (std::size_t i = 0; i < ref::trial_rayleigh_spinning.size(); ++i)
    EXPECT_NEAR(rayleigh[i].frequency / ref::trial_rayleigh_spinning[i], 1, 5e-6) << i;
  const auto rest = modes(shaft(60, rotor::Shear::rigid, false), 0);
  for (std::size_t i = 0; i < ref::trial_rayleigh_rest.size(); ++i)
    for (std::size_t twin : {2 * i, 2 * i + 1})
      EXPECT_NEAR(std::abs(rest[twin].frequency) / ref::trial_rayleigh_rest[i], 1, 5e-6) << i;
}

TEST(Beam, RayleighElementConvergesWithOrderFour) {
  const double diameter = 0.12, e = 2.1e11, r2 = diameter * diameter / 16;  // r radius of gyration of the section
  std::vector<std::vector<double>> error;
  for (int elements : {6, 12, 24}) {
    rotor::Options o = test::uniform_shaft(1.0, diameter, elements, e);
    o.shear = rotor::Shear::rigid;
    const auto found = rotor::natural_frequencies(MPI_COMM_WORLD, o, {1, elements + 1}, 3);
    error.emplace_back();
    for (int n = 1; n <= 3; ++n) {
      const double b2 = std::pow(n * pi, 2), exact = b2 * std::sqrt(e * r2 / 7850 / (1 + r2 * b2));
      error.back().push_back(found[static_cast<std::size_t>(n - 1)] / exact - 1);
    }
  }
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_GT(error[2][n], 0);  // a conforming element is too stiff, never too soft
    EXPECT_GE(std::log2(error[0][n] / error[1][n]), 3.9) << "mode " << n + 1;
    EXPECT_GE(std::log2(error[1][n] / error[2][n]), 3.9) << "mode " << n + 1;
  }
}

// The shear angle is constant in the element and tied to its curvature. To leading order the frequency of a pinned mode
// of wave number b is too high by the energy of what that leaves out, relative to the energy of the mode (section
// rotation of unit amplitude): h^2/24 [S g^2 b^2 + (j w^2)^2/(E I)] / [E I b^2 + S g^2], with the shear angle S g = E I
// b^2 - j w^2.
TEST(Beam, TimoshenkoElementConvergesToTheExactFrequenciesWithTheErrorOfItsConstantShear) {
  const double length = 1.0, diameter = 0.12, e = 2.1e11, rho = 7850, nu = 0.3;
  const double area = pi / 4 * diameter * diameter, i = pi / 64 * std::pow(diameter, 4);
  const double shear = 6 * (1 + nu) / (7 + 6 * nu) * e / (2 * (1 + nu)) * area;
  std::vector<std::vector<double>> error;
  for (int elements : {16, 32, 64}) {
    const auto found = rotor::natural_frequencies(MPI_COMM_WORLD, test::uniform_shaft(length, diameter, elements),
                                                  {1, elements + 1}, 3);
    error.emplace_back();
    for (int n = 1; n <= 3; ++n)
      error.back().push_back(
          found[static_cast<std::size_t>(n - 1)] / timoshenko_pinned(n, length, e * i, rho * area, rho * i, shear) - 1);
  }
  for (std::size_t n = 0; n < 3; ++n) {
    EXPECT_GE(std::log2(error[0][n] / error[1][n]), 1.9) << "mode " << n + 1;
    EXPECT_GE(std::log2(error[1][n] / error[2][n]), 1.9) << "mode " << n + 1;
    const double b = static_cast<double>(n + 1) * pi / length, ei = e * i;
    const double w = timoshenko_pinned(static_cast<int>(n) + 1, length, ei, rho * area, rho * i, shear);
    const double spin = rho * i * w * w, sg = ei * b * b - spin;
    const double predicted =
        (sg * sg / shear * b * b + spin * spin / ei) / (ei * b * b + sg * sg / shear) / (64 * 64 * 24);
    EXPECT_NEAR(error[2][n] / predicted, 1, 0.02) << "mode " << n + 1;
    EXPECT_LT(std::abs((4 * error[2][n] - error[1][n]) / 3), 3e-7 * std::pow(3, n)) << "extrapolated, mode " << n + 1;
  }
}

// As many modes as a small shaft has, and more: the whole spectrum, whatever is asked for.
TEST(Beam, AllModesOfAShaftOfFewElements) {
  const rotor::Options o = test::uniform_shaft(1, 0.05, 4);
  const auto most = rotor::natural_frequencies(MPI_COMM_WORLD, o, {}, 5);
  for (const int count : {7, 8, 14}) {
    const auto all = rotor::natural_frequencies(MPI_COMM_WORLD, o, {}, count);
    ASSERT_EQ(all.size(), static_cast<std::size_t>(std::min(count, 8)));  // 10 freedoms, 2 rigid motions
    for (std::size_t k = 0; k < most.size(); ++k) EXPECT_NEAR(all[k], most[k], 1e-6 * most[k]);
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
    EXPECT_GT(all.front(), 1.0);
  }
}

TEST(Beam, FreeShaftWithoutPinsKeepsOnlyBendingModes) {
  // Slender Euler-Bernoulli limit: beta L = 4.730041, 7.853205 free-free; 3.926602 pinned at one end.
  const double length = 1, diameter = 0.004, e = 2.1e11;
  const rotor::Options o = test::uniform_shaft(length, diameter, 20);
  const double scale = std::sqrt(e * diameter * diameter / 16 / 7850);
  const auto free = rotor::natural_frequencies(MPI_COMM_WORLD, o, {}, 2);
  EXPECT_NEAR(free[0] / (4.730041 * 4.730041 * scale), 1, 2e-4);
  EXPECT_NEAR(free[1] / (7.853205 * 7.853205 * scale), 1, 5e-4);
  const auto hinged = rotor::natural_frequencies(MPI_COMM_WORLD, o, {1}, 1);
  EXPECT_NEAR(hinged[0] / (3.926602 * 3.926602 * scale), 1, 2e-4);
  const auto all = rotor::natural_frequencies(MPI_COMM_WORLD, test::uniform_shaft(1, 0.1, 1), {1, 2}, 10);
  EXPECT_EQ(all.size(), 2u);
  EXPECT_THROW((void)rotor::natural_frequencies(MPI_COMM_WORLD, o, {22}, 1), core::InputError);
}
