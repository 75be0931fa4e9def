// Orifices of films of gas: laws of discharge, pockets and their volume, places between nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "film/gas/gas_feed.hpp"
#include "film/gas_cases.hpp"
#include "film/sheet/lattice.hpp"
#include "whirl/core/error.hpp"
#include "whirl/thermal/orifice.hpp"

namespace whirl::film::testing {
namespace {

using std::numbers::pi;
using Law = OrificeRow::Law;

// Eqs. (3.9), (3.12): the flow stands on both sides.
TEST(GasFeed, FlowByItsOwnReynoldsNumber) {
  constexpr double unit = 2.9e-9, rate = 1e-3;
  for (const double ideal : {1.5e-5, 4e-6, 3.1e-6, 2e-6, 1e-8, -1.5e-5}) {
    const thermal::Discharged m = thermal::discharged(ideal, rate, unit);
    const auto root = [](double a, double k, double flow) {
      return a * (1.0 - std::exp(-k * std::hypot(flow / unit, 1.0)));
    };
    EXPECT_NEAR(root(ideal, rate, m.mass), m.mass, 1e-13 * std::abs(ideal)) << ideal;
    // Differences fall with the square of the step.
    for (const double step : {1e-3, 1e-4}) {
      const auto at = [&](double a, double k) { return thermal::discharged(a, k, unit).mass; };
      const double by_ideal = (at(ideal * (1 + step), rate) - at(ideal * (1 - step), rate)) / (2 * step * ideal);
      const double by_rate = (at(ideal, rate * (1 + step)) - at(ideal, rate * (1 - step))) / (2 * step * rate);
      EXPECT_NEAR(m.by_ideal, by_ideal, 5e3 * step * step * std::abs(m.by_ideal) + 1e-8) << ideal;
      EXPECT_NEAR(m.by_rate, by_rate, 5e3 * step * step * std::abs(m.by_rate) + 1e-8 * std::abs(ideal) / rate) << ideal;
    }
  }
  EXPECT_NEAR(thermal::discharged(1e-5, 1.0, unit).mass, 1e-5, 1e-20);  // a coefficient of one
}

// By another way: the flow of the Mach number behind, M^2 = 5 ((p_s/p)^(2/7) - 1) or 1, m = A p_s sqrt(1.4/(r T)) M/(1
// + M^2/5)^3, and eqs. (3.8)-(3.13) as printed, by iteration over Re (the one that the code adds to Re^2 is less than
// 2e-6 of the flow). r = 286.7 J/(kg K), T = 300 K, viscosity 18.46 uPa s, supply 0.6 MPa.
TEST(GasFeed, FlowsByHand) {
  struct Case {
    Law law;
    double diameter, thickness, depth, behind, mass;  // m, Pa, kg/s
  };
  const GasMesh mesh{48, 15, 1e-3, 1e-3, 2 * pi / 48, 0.0, 0.03};
  for (const Case& c : {Case{Law::thickness, 0.2e-3, 20e-6, 0.0, 2e5, 2.093239847e-05},     // (3.8), choked
                        Case{Law::thickness, 0.2e-3, 20e-6, 0.0, 5e5, 1.599718019e-05},     // M = 0.517
                        Case{Law::thickness, 0.4e-3, 20e-6, 15e-6, 4e5, 7.329192884e-05},   // h_f/d = 0.0875
                        Case{Law::reynolds, 0.2e-3, 20e-6, 15e-6, 3e5, 2.808924439e-05},    // (3.9), Re = 9687, choked
                        Case{Law::reynolds, 0.2e-3, 20e-6, 15e-6, 4.5e5, 2.457008660e-05},  // Re = 8473
                        Case{Law::curtain, 0.2e-3, 15e-6, 0.0, 2e5, 1.382726675e-05},       // (3.12), Re = 1192, choked
                        Case{Law::curtain, 0.2e-3, 15e-6, 0.0, 4e5, 1.321702989e-05}}) {    // Re = 1140
    OrificeRow row{1, 0.0, 0.0, c.diameter, 6e5, c.law, {}};
    if (c.depth > 0.0) row.pocket = Pocket{1e-3, c.depth};
    const GasFeed feed(row, 0, Gas{}, air().viscosity, mesh);
    const double mass = c.depth > 0.0 ? feed.into_pocket({c.behind, 0.0}, c.thickness).mass
                                      : feed.into_film({c.behind, 0.0}, c.thickness).mass;
    EXPECT_NEAR(mass, c.mass, 3e-6 * c.mass) << c.diameter << ' ' << c.behind;
  }
}

// The same of two restrictors: 0.2 mm into a pocket of 2 mm, 60 um deep, at 0.52 MPa (Re = 7908), and over its rim of
// 20 um at 0.5 MPa (Re = 504). The pocket of 0.1885 mm^3 holds 2.19155e-15 kg/Pa of a gas of r T = 86010 m^2/s^2.
TEST(GasFeed, PocketsFillByHand) {
  constexpr double in = 2.293098533e-05, out = 5.841411978e-05, rate = -1.619085567e10;  // kg/s, Pa/s
  Gas o = aerostatic(1, 6e5, {16, 8});
  o.orifices[0].law = Law::two_restrictors;
  o.orifices[0].pocket = Pocket{2e-3, 60e-6};
  const GasMesh mesh{48, 15, 1e-3, 1e-3, 2 * pi / 48, 0.0, 0.03};
  const GasFeed feed(o.orifices[0], 0, o, air().viscosity, mesh);
  EXPECT_NEAR(feed.into_film({5e5, 5.2e5}, 20e-6).mass, out, 3e-6 * out);
  EXPECT_NEAR(feed.into_pocket({5e5, 5.2e5}, 20e-6).mass, in - out, 3e-6 * out);
  EXPECT_NEAR(feed.capacity(), 2.191553996e-15, 1e-9 * 2.2e-15);
  // The centred film: 112 nodes, then rims, then pockets.
  const auto film = make(spindle(), o, air());
  std::vector<double> states(film->states(), 2e5), rates(film->states(), 0.0);
  for (std::size_t k = 0; k < 8; ++k) {
    states[112 + k] = 5e5;
    states[120 + k] = 5.2e5;
  }
  StateResponse r;
  film->evaluate({}, states, rates, Need::force, r);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(r.residual[120 + k], -rate, -1e-5 * rate);
}

// The other law of the errata on bearing A, eps 0.6, 0.5 MPa, 1000 rad/s: 57.8736 N and 0.115217 g/s on 192x64 cells.
TEST(GasFeed, CurtainArea) {
  Gas o = aerostatic(1, 5e5, {96, 32});
  const SolvedGas orifice = solved(spindle(), o, {0.6, 0.0}, 1000.0);
  o.orifices[0].law = Law::curtain;
  const SolvedGas curtain = solved(spindle(), o, {0.6, 0.0}, 1000.0);
  EXPECT_NEAR(load_of(curtain), 57.87356, 2e-3 * 57.9);
  EXPECT_NEAR(curtain.report.mass_flow, 1.15217068e-4, 1e-4 * 1.15e-4);
  EXPECT_NEAR(curtain.report.power_loss, 0.8003465, 5e-4);
  EXPECT_NEAR(load_of(curtain) / load_of(orifice), 0.85, 0.005);
  EXPECT_NEAR(curtain.report.mass_flow / orifice.report.mass_flow, 1.0 - 0.034, 0.001);
  EXPECT_LE(curtain.factorisations, 12);
}

// Two restrictors pass the same flow, and a pocket takes a part of the pressure; wider pockets carry more.
TEST(GasFeed, Pockets) {
  double before = 0.0;
  for (const double diameter : {1e-3, 2e-3, 4e-3}) {
    Gas o = aerostatic(1, 6e5, {48, 16});
    o.orifices[0].law = Law::two_restrictors;
    o.orifices[0].pocket = Pocket{diameter, 60e-6};
    const SolvedGas s = solved(spindle(), o, {0.5, 0.0}, 1000.0);
    const std::size_t n = 48 * 15;
    double through = 0.0;
    for (std::size_t k = 0; k < 8; ++k) {
      const double rim = s.states[n + k], pocket = s.states[n + 8 + k];
      EXPECT_GT(pocket, rim);
      EXPECT_GT(6e5, pocket);
      // eq. (3.11) by hand, with h at the orifice
      const double h = 20e-6 * (1.0 - 0.5 * std::cos(0.25 * pi * static_cast<double>(k)));
      const double ideal = 1.05 * pi * diameter * h * thermal::nozzle({}, pocket, 300.0, rim).value;
      through += thermal::discharged(ideal, 5e-3, pi * diameter * air().viscosity).mass;
    }
    EXPECT_NEAR(through, s.report.mass_flow, 1e-9 * through);
    EXPECT_NEAR(s.report.imbalance, 0.0, 1e-12 * s.report.side_flow);
    EXPECT_GT(load_of(s), before + 5.0);
    EXPECT_LE(s.factorisations, 12);
    before = load_of(s);
  }
}

// Also where the mesh resolves the rim of a pocket.
TEST(GasFeed, PocketsConvergeWithTheMesh) {
  Gas o = aerostatic(1, 6e5, {});
  o.orifices[0].law = Law::reynolds;
  o.orifices[0].pocket = Pocket{3e-3, 15e-6};
  std::array<double, 3> load{};
  for (std::size_t k = 0; k < 3; ++k) {
    o.cells = {24 << k, 8 << k};
    load[k] = load_of(solved(spindle(), o, {0.5, 0.0}, 1000.0));
  }
  EXPECT_LT(std::abs(load[2] - load[1]), 0.01 * load[2]);
  EXPECT_GT(std::log2(std::abs((load[1] - load[0]) / (load[2] - load[1]))), 1.3);
}

// On any mesh the rim lies above its nodes by what a ring loses that is smeared over cells: a share of a cell over the
// rim. Were it below them, gas would flow out of a pocket that has less pressure than the film.
TEST(GasFeed, RimsOfPocketsResist) {
  const Gas gas;
  for (const double dz : {0.5e-3, 1e-3, 2e-3})
    for (const double rim : {1e-3, 3e-3, 6e-3, 12e-3})
      for (const double away : {0.0, 0.31, 0.5}) {
        const GasMesh mesh{100, static_cast<int>(std::lround(0.1 / dz)) - 1, 1e-3, dz, 0.02 * pi, 0.0, 0.1};
        const OrificeRow row{
            1, away * dz, away * mesh.dtheta, 0.2e-3, 6e5, OrificeRow::Law::reynolds, Pocket{2 * rim, 15e-6}};
        const double smeared = -GasFeed(row, 0, gas, air().viscosity, mesh).distance() * rim / std::hypot(1e-3, dz);
        EXPECT_GT(smeared, 0.09) << dz << ' ' << rim << ' ' << away;
        EXPECT_LT(smeared, 0.2) << dz << ' ' << rim << ' ' << away;
      }
}

// A pocket fills late: pneumatic hammer, and less stiffness at a frequency. At rest its volume does not show.
TEST(GasFeed, VolumesOfPocketsTakeDampingAway) {
  double stiffness = 0.0, before = 1e9;
  for (const double depth : {0.4e-3, 2e-3, 10e-3}) {
    Gas o = aerostatic(1, 6e5, {48, 16});
    o.orifices[0].law = Law::two_restrictors;
    o.orifices[0].pocket = Pocket{2e-3, depth};
    const SolvedGas s = solved(spindle(), o, {0.2, 0.0}, 0.0);
    const PortCoefficients slow = port_coefficients(*s.film, s.motion, s.states, 1e-2);
    const PortCoefficients c = port_coefficients(*s.film, s.motion, s.states, 1000.0);
    if (stiffness > 0.0) {
      EXPECT_NEAR(slow.stiffness[0][0], stiffness, 1e-3 * stiffness);
    }
    stiffness = slow.stiffness[0][0];
    EXPECT_LT(slow.damping[0][0], before - 100.0);
    EXPECT_LT(c.stiffness[0][0], stiffness);
    before = slow.damping[0][0];
  }
  EXPECT_LT(before, 0.0);
}

// Known values of the mesh's own field: along a diagonal of any mesh, and 1/4 of the flow beside a node of squares.
TEST(GasFeed, FieldOfTheMesh) {
  const double self = std::log(0.25 * std::numbers::sqrt2) - std::numbers::egamma;
  EXPECT_NEAR(log_distance(1.0, 1.0, 0, 0), self, 1e-14);
  EXPECT_NEAR(log_distance(1.0, 1.0, 1, 0), self + 0.5 * pi, 1e-9);
  for (const double dz : {0.5, 1.0, 3.0})
    EXPECT_NEAR(log_distance(1.0, dz, 1, 1) - log_distance(1.0, dz, 0, 0), 2.0, 1e-8);
  EXPECT_NEAR(log_distance(1.0, 2.0, 1, 0) - log_distance(1.0, 2.0, 0, 0), std::atan(2.0), 1e-9);
  EXPECT_NEAR(log_distance(1.0, 2.0, 20, 10), std::log(std::hypot(20.0, 20.0)), 1e-3);
}

// The mesh begins at the first row: the order of two rows moves it by any part of a cell.
TEST(GasFeed, PlaceOnTheMeshDoesNotShow) {
  for (const double angle : {0.03, 0.07, 0.11}) {
    std::array<double, 2> apart{};
    for (std::size_t k = 0; k < 2; ++k) {
      Gas o = aerostatic(2, 6e5, {24 << k, 8 << k}), other = o;
      o.orifices[1].angle = other.orifices[1].angle = angle;
      std::swap(other.orifices[0], other.orifices[1]);
      const double a = load_of(solved(spindle(), o, {0.5, 0.0}, 1000.0));
      apart[k] = std::abs(load_of(solved(spindle(), other, {0.5, 0.0}, 1000.0)) - a) / a;
    }
    // Errors of these meshes: 2.7 and 0.7 %.
    EXPECT_LT(apart[0], 5e-4) << angle;
    EXPECT_LT(apart[1], 3e-4) << angle;
  }
}

// Continuous where an orifice passes a node, and as smooth between.
TEST(GasFeed, LoadIsContinuousInThePlace) {
  const auto load = [](double z) {
    Gas o = aerostatic(2, 6e5, {24, 8});
    o.orifices[0].z = -z;
    o.orifices[1].z = z;
    return load_of(solved(spindle(), o, {0.5, 0.0}, 1000.0));
  };
  const double node = 7.5e-3;
  EXPECT_NEAR(load(node - 1e-9), load(node + 1e-9), 1e-4);
  double worst = 0.0;  // second differences
  for (double z = 6e-3; z < 9e-3; z += 0.6e-3)
    worst = std::max(worst, std::abs(load(z + 0.3e-3) - 2.0 * load(z) + load(z - 0.3e-3)));
  EXPECT_LT(worst, 0.15);  // of 97 N
}

TEST(GasFeed, RefusesWhatDoesNotFit) {
  Gas o = aerostatic(1, 5e5, {24, 8});
  o.orifices[0].law = Law::two_restrictors;
  EXPECT_THROW((void)make(spindle(), o, air()), core::InputError);
  o.orifices[0].pocket = Pocket{0.1e-3, 50e-6};
  EXPECT_THROW((void)make(spindle(), o, air()), core::InputError);
  o.orifices[0].pocket = Pocket{1e-3, 50e-6};
  EXPECT_NO_THROW((void)make(spindle(), o, air()));
  o.source = Gas::Source::node;
  EXPECT_THROW((void)make(spindle(), o, air()), core::InputError);
  o = aerostatic(1, 5e5, {6, 4});
  EXPECT_THROW((void)make(spindle(), o, air()), core::InputError);
  o = aerostatic(1, 5e5, {24, 8});
  o.orifices[0].pocket = Pocket{2e-3, 50e-6};
  EXPECT_EQ(facts_of(o, spindle()).misplaced.option, "orifices.1.law");
  o.orifices[0].pocket->depth = 15e-6;  // (20 um + 15 um)/0.2 mm = 0.175
  EXPECT_EQ(facts_of(o, spindle()).misplaced.option, "orifices.1.law");
  o.orifices[0].law = Law::reynolds;
  EXPECT_TRUE(facts_of(o, spindle()).misplaced.reason.empty());
  EXPECT_NO_THROW((void)make(spindle(), o, air()));
}

// Beside the pads of a lemon bore, over each other, or next to an end.
TEST(GasFeed, RefusesWhereNoOrificeFits) {
  Geometry lemon = spindle();
  lemon.type = Geometry::Bore::lemon_bore;
  lemon.arc = 150.0 / 180.0 * pi;
  const auto option = [](const Geometry& g, const Gas& o) { return facts_of(o, g).misplaced.option; };
  Gas o = aerostatic(1, 5e5, {48, 16});
  EXPECT_EQ(option(lemon, o), "orifices.1.angle");  // at 0 deg
  EXPECT_THROW((void)make(lemon, o, air()), core::InputError);
  o.orifices[0].count = 2;
  o.orifices[0].angle = 0.5 * pi;
  EXPECT_EQ(option(lemon, o), "");
  EXPECT_NO_THROW((void)make(lemon, o, air()));
  // Half an orifice over the edge at 165 deg.
  o.orifices[0].angle = (165.0 - 0.1) / 180.0 * pi;
  EXPECT_EQ(option(lemon, o), "orifices.1.angle");

  // Eight pockets of 11.7 mm go around a circle of 94.2 mm; two rows 7 mm apart are not wide enough for them.
  o = aerostatic(1, 5e5, {48, 16});
  o.orifices[0].law = Law::two_restrictors;
  o.orifices[0].pocket = Pocket{11.7e-3, 60e-6};
  EXPECT_EQ(option(spindle(), o), "");
  o.orifices[0].pocket->diameter = 11.9e-3;
  EXPECT_EQ(option(spindle(), o), "orifices.1.pocket");
  EXPECT_THROW((void)make(spindle(), o, air()), core::InputError);
  o.orifices[0].pocket->diameter = 6e-3;
  o.orifices.push_back(o.orifices[0]);
  o.orifices[0].z = -3.5e-3;
  o.orifices[1].z = 3.5e-3;
  EXPECT_EQ(option(spindle(), o), "");
  o.orifices[0].pocket->diameter = 8.2e-3;
  EXPECT_EQ(option(spindle(), o), "orifices.2.pocket");
  o.orifices[1].angle = pi / 8;  // between those of the other row
  EXPECT_EQ(option(spindle(), o), "");

  // Cells of 1.875 mm: up to 13.125 mm from the middle.
  o = aerostatic(1, 5e5, {48, 16});
  o.orifices[0].z = 13.125e-3;
  EXPECT_EQ(option(spindle(), o), "");
  o.orifices[0].z = -13.2e-3;
  EXPECT_EQ(option(spindle(), o), "orifices.1.z");
  o.cells[1] = 20;
  EXPECT_EQ(option(spindle(), o), "");
}

}  // namespace
}  // namespace whirl::film::testing
