// Films of gas with slip, in lobed bores, on pads and with grooves, against closed forms and the incompressible film.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "film/gas_cases.hpp"

namespace whirl::film::testing {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

// a = mu sqrt(pi r T/2): a Knudsen number is a/(p h).
double rarefied() {
  return air().viscosity * std::sqrt(0.5 * pi * Gas{}.gas_constant * Gas{}.temperature);
}

// A slit that feeds a gap of one thickness: p^2 + 12 a p/h + 12 a^2/h^2 ln p is linear from it to the ends.
TEST(GasSlip, PressureOfASlot) {
  Geometry g = spindle();
  g.clearance = 2e-6;
  const double a = rarefied() / g.clearance;
  std::array<double, 3> mass{};
  for (const Gas::Slip slip : {Gas::Slip::none, Gas::Slip::first, Gas::Slip::second}) {
    Gas o = self_acting({16, 8});
    o.slip = slip;
    o.orifices = {{16, 0.0, 0.0, 0.02e-3, 3e5}};
    const SolvedGas s = solved(g, o, {0.0, 0.0}, 0.0);
    const auto drive = [&](double p) {
      return p * p + (slip == Gas::Slip::none ? 0.0 : 12.0 * a * p) +
             (slip == Gas::Slip::second ? 12.0 * a * a * std::log(p) : 0.0);
    };
    const double top = drive(s.states[3]), end = drive(o.ambient);
    for (std::size_t j = 0; j < 7; ++j) {
      const double share = 1.0 - std::abs(static_cast<double>(j) - 3.0) / 4.0;
      EXPECT_NEAR(drive(s.states[j]), end + (top - end) * share, 1e-12 * top);
    }
    const double flow = 2.0 * 2.0 * pi * g.radius * std::pow(g.clearance, 3) * (top - end) /
                        (24.0 * air().viscosity * o.gas_constant * o.temperature * 0.5 * g.length);
    EXPECT_NEAR(s.report.mass_flow, flow, 1e-10 * flow);
    mass[static_cast<std::size_t>(slip)] = flow;
  }
  EXPECT_GT(mass[1], mass[0]);
  EXPECT_GT(mass[2], mass[1]);
}

// Linearised in the eccentricity slip divides the bearing number by 1 + 6 Kn + 6 Kn^2.
TEST(GasSlip, SmallEccentricities) {
  constexpr double small = 1e-4, number = 2.0;
  Geometry g = spindle();
  for (const double clearance : {20e-6, 2e-6, 0.4e-6}) {
    g.clearance = clearance;
    const double slender = g.radius / g.clearance,
                 speed = number * 101325.0 / (6.0 * air().viscosity * slender * slender);
    const double knudsen = rarefied() / (101325.0 * clearance);
    for (const Gas::Slip slip : {Gas::Slip::first, Gas::Slip::second}) {
      const double factor = 1.0 + 6.0 * knudsen + (slip == Gas::Slip::second ? 6.0 * knudsen * knudsen : 0.0);
      const Complex il(0.0, number / factor), k = std::sqrt(1.0 + il);
      const Complex exact = 0.5 * pi * il / (1.0 + il) * (1.0 - std::tanh(k) / k);
      std::array<double, 2> error{};
      for (std::size_t n = 0; n < 2; ++n) {
        Gas o = self_acting({24 << n, 12 << n});
        o.slip = slip;
        const SolvedGas s = solved(g, o, {small, 0.0}, speed);
        const Complex load(-s.journal.force[0], s.journal.force[1]);
        error[n] = std::abs(load / (o.ambient * g.length * 2.0 * g.radius * small) - exact) / std::abs(exact);
      }
      EXPECT_LT(error[1], 5e-3) << clearance;
      EXPECT_NEAR(std::log2(error[0] / error[1]), 2.0, 0.15) << clearance;
    }
  }
}

// The limit of low speeds is the incompressible film without cavitation in the same bore.
void same_as_incompressible(const Geometry& g, const Gas& gas, Reynolds oil, std::array<int, 2> cells) {
  oil.cavitation = Reynolds::Cavitation::none;
  oil.cells = cells;
  const SolvedGas s = solved(g, gas, {0.3, -0.2}, 0.5);
  const auto film = make_film(g, oil, air());
  Response r;
  film->evaluate(s.motion, Need::force, r);
  const double all = std::hypot(r.force[0], r.force[1]);
  EXPECT_NEAR(s.journal.force[0], r.force[0], 5e-3 * all);
  EXPECT_NEAR(s.journal.force[1], r.force[1], 5e-3 * all);
  EXPECT_NEAR(s.report.min_thickness, r.min_thickness, 1e-15);
  EXPECT_NEAR(s.report.imbalance, 0.0, 1e-9 * s.motion.speed * g.radius * g.clearance * g.length);
}

TEST(GasBore, PadsLobesAndGroovesAtLowSpeeds) {
  Geometry lemon = spindle();
  lemon.type = Geometry::Bore::lemon_bore;
  lemon.arc = 150.0 / 180.0 * pi;
  lemon.preload = 0.4;
  same_as_incompressible(lemon, self_acting({72, 24}), {}, {30, 24});
  Geometry arc = lemon;
  arc.type = Geometry::Bore::partial_arc;
  arc.preload = 0.0;
  arc.arc = 120.0 / 180.0 * pi;
  same_as_incompressible(arc, self_acting({72, 24}), {}, {24, 24});
  Gas grooved = self_acting({72, 24});
  grooved.grooves = {{0.5 * pi, 20.0 / 180.0 * pi, 0.0}, {1.5 * pi, 0.0, 0.0}};
  Reynolds oil;
  oil.grooves = grooved.grooves;
  same_as_incompressible(spindle(), grooved, oil, {72, 24});
}

// Two lobes with vented joints are the lemon bore of 180 deg; three lobes carry nothing in the middle and alike in
// three directions, and preload makes them stiffer than the circle of the same radius.
TEST(GasBore, Lobes) {
  Geometry lemon = spindle();
  lemon.type = Geometry::Bore::lemon_bore;
  lemon.arc = pi;
  lemon.preload = 0.5;
  Gas two = self_acting({48, 16});
  two.lobes = Lobes{2, 0.5, 1.5 * pi};
  two.grooves = {{0.0, 0.0, 0.0}, {pi, 0.0, 0.0}};
  const SolvedGas a = solved(lemon, self_acting({48, 16}), {0.2, 0.3}, 2000.0);
  const SolvedGas b = solved(spindle(), two, {0.2, 0.3}, 2000.0);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(a.journal.force[i], b.journal.force[i], 1e-9 * load_of(a));

  Gas three = self_acting({48, 16});
  three.lobes = Lobes{3, 0.5, 1.5 * pi};
  EXPECT_LT(load_of(solved(spindle(), three, {0.0, 0.0}, 2000.0)), 1e-9);
  const SolvedGas here = solved(spindle(), three, {0.2, 0.1}, 2000.0);
  const Complex turn = std::polar(1.0, 2.0 * pi / 3.0), place = Complex(0.2, 0.1) * turn;
  const SolvedGas there = solved(spindle(), three, {place.real(), place.imag()}, 2000.0);
  const Complex force = Complex(here.journal.force[0], here.journal.force[1]) * turn;
  EXPECT_NEAR(there.journal.force[0], force.real(), 1e-9 * std::abs(force));
  EXPECT_NEAR(there.journal.force[1], force.imag(), 1e-9 * std::abs(force));
  const auto stiffness = [](const SolvedGas& s) {
    return port_coefficients(*s.film, s.motion, s.states, 1.0).stiffness[0][0];
  };
  Geometry assembled = spindle();
  assembled.clearance = 10e-6;  // lobes of 20 um
  EXPECT_GT(stiffness(solved(assembled, three, {0.0, 0.0}, 1000.0)),
            stiffness(solved(spindle(), self_acting({48, 16}), {0.0, 0.0}, 1000.0)));
}

// A groove under pressure feeds the film: what it gives leaves at the ends, and the journal is pushed away from it.
TEST(GasBore, GrooveUnderPressure) {
  Gas o = self_acting({48, 16});
  o.grooves = {{1.5 * pi, 0.3, 3e5}};
  const SolvedGas s = solved(spindle(), o, {0.0, 0.0}, 0.0);
  EXPECT_GT(s.journal.force[1], 10.0);
  EXPECT_NEAR(s.report.imbalance, 0.0, 1e-12 * s.report.side_flow);
  EXPECT_GT(s.report.side_flow, 0.0);
  EXPECT_NEAR(s.report.max_pressure, 3e5, 1e-6);
}

}  // namespace
}  // namespace whirl::film::testing
