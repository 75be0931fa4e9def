// Films of gas against computations of bearings A and B and against each other: loads, consumption, drag, coefficients.
#include <gtest/gtest.h>

#include <cmath>

#include "film/gas_cases.hpp"
#include "film/gas_reference.hpp"

namespace whirl::film::testing {
namespace {

TEST(Gas, LoadsConsumptionAndDragOfTheTables) {
  double worst = 0.0, worst_flow = 0.0, worst_torque = 0.0;
  for (const GasLoad& r : gas_loads) {
    SCOPED_TRACE(::testing::Message() << r.rows << " rows, " << r.supply << " Pa, " << r.speed << " rad/s, eps "
                                      << r.eccentricity);
    const SolvedGas s = solved(spindle(), aerostatic(r.rows, r.supply, {96, 32}), {r.eccentricity, 0.0}, r.speed);
    const double load = std::hypot(r.along, r.across);
    EXPECT_NEAR(s.journal.force[0], r.along, 5e-3 * load);
    EXPECT_NEAR(s.journal.force[1], r.across, 5e-3 * load);
    EXPECT_NEAR(s.report.mass_flow, r.mass_flow, 5e-3 * r.mass_flow);
    EXPECT_NEAR(s.report.drag_torque, r.torque, 5e-3 * std::abs(r.torque) + 1e-15);
    EXPECT_NEAR(s.report.imbalance, 0.0, 1e-12 * s.report.side_flow);
    EXPECT_LE(s.factorisations, 12);
    worst = std::max(worst, std::abs(load_of(s) / load - 1.0));
    worst_flow = std::max(worst_flow, std::abs(s.report.mass_flow / r.mass_flow - 1.0));
    if (r.torque != 0.0) worst_torque = std::max(worst_torque, std::abs(s.report.drag_torque / r.torque - 1.0));
  }
  RecordProperty("load", std::to_string(worst));
  RecordProperty("flow", std::to_string(worst_flow));
  RecordProperty("torque", std::to_string(worst_torque));
}

// The rim of an orifice has a pressure, the node of a point source has none: 003 errata sec. 2.
TEST(Gas, OnlyThePressureAtTheRimConverges) {
  std::array<double, 3> rim{}, node{};
  for (std::size_t k = 0; k < 3; ++k) {
    Gas o = aerostatic(1, 5e5, {48 << k, 16 << k});
    rim[k] = load_of(solved(spindle(), o, {0.6, 0.0}, 1000.0));
    o.source = Gas::Source::node;
    node[k] = load_of(solved(spindle(), o, {0.6, 0.0}, 1000.0));
  }
  EXPECT_NEAR(rim[1], 67.80785, 1e-4);  // the reference on the same meshes
  EXPECT_NEAR(rim[2], 67.88151, 1e-4);
  EXPECT_NEAR(node[1], 72.34146, 1e-4);
  EXPECT_NEAR(node[2], 67.56120, 1e-4);
  const double order = std::log2((rim[1] - rim[0]) / (rim[2] - rim[1]));
  EXPECT_NEAR(order, 2.0, 0.2);
  EXPECT_GT((node[1] - node[2]) / (node[0] - node[1]), 0.8);  // steps that do not fall
  EXPECT_GT(node[1] - node[2], 4.0);
}

// From a cold start, on the mesh of the reference, over eccentricities and speeds.
TEST(Gas, ColdStartsTakeFewFactorisations) {
  for (const double speed : {0.0, 1e4})
    for (const double eccentricity : {0.0, 0.9})
      EXPECT_LE(solved(spindle(), aerostatic(1, 6e5, {192, 64}), {eccentricity, 0.3}, speed).factorisations, 12)
          << speed << " " << eccentricity;
}

// Equilibrium under a load in -x and coefficients there, by perturbation.
struct Equilibrium {
  SolvedGas at;
  PortCoefficients coefficients;
};
Equilibrium equilibrium(const Gas& options, double load, double speed, double omega) {
  const Geometry bore = spindle();
  Gas condensed = options;
  condensed.states = States::condensed;
  const auto film = make_film(bore, condensed, air());
  JournalMotion m;
  m.speed = speed;
  Response r;
  for (int step = 0; step < 20; ++step) {
    film->evaluate(m, Need::tangents, r);
    const double fx = r.force[0] - load, fy = r.force[1];
    const auto& k = r.d_position;
    const double det = k[0][0] * k[1][1] - k[0][1] * k[1][0];
    m.position[0] -= (k[1][1] * fx - k[0][1] * fy) / det;
    m.position[1] -= (k[0][0] * fy - k[1][0] * fx) / det;
    if (std::hypot(fx, fy) < 1e-10 * load) break;
  }
  SolvedGas at = solved(bore, options, {m.position[0] / bore.clearance, m.position[1] / bore.clearance}, speed);
  PortCoefficients c = port_coefficients(*at.film, at.motion, at.states, omega);
  return {std::move(at), c};
}

// Bearing B at 0.6 MPa, 2000 rad/s, 49.05 N, synchronous. The reference turns by theta = -dy/dz, psi = dx/dz.
TEST(Gas, CoefficientsOfTheLoadedBearing) {
  Gas o = aerostatic(2, 6e5, {96, 32});
  o.tilt = true;
  const Equilibrium e = equilibrium(o, 49.05, 2000.0, 2000.0);
  EXPECT_NEAR(e.at.motion.position[0], -4.5495e-6, 5e-3 * 4.56e-6);
  EXPECT_NEAR(e.at.motion.position[1], -0.31541e-6, 5e-3 * 4.56e-6);
  const double K[4][4] = {
      {11.008e6, 0.5862e6, 0, 0}, {-0.7216e6, 11.060e6, 0, 0}, {0, 0, 606.9, 16.21}, {0, 0, -17.17, 588.7}};
  const double B[4][4] = {
      {868.7, -168.5, 0, 0}, {216.8, 676.8, 0, 0}, {0, 0, 18.96e-3, -1.362e-3}, {0, 0, 1.893e-3, 15.68e-3}};
  // The reference on this mesh, which takes the thickness of a cell in its middle.
  const double K96[2][2] = {{10984207.910506524, 585366.6138329715}, {-721293.522564153, 11036484.459778082}};
  const double B96[2][2] = {{867.7262072387726, -168.34107442500124}, {216.76077854710172, 675.3510587528583}};
  ASSERT_EQ(e.coefficients.ports, 4u);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      const bool moments = i > 1, slopes = j > 1;
      const double k = moments != slopes ? 11e6 * 0.03 : (moments ? K[2][2] : K[0][0]);
      const double b = moments != slopes ? 868.7 * 0.03 : (moments ? B[2][2] : B[0][0]);
      // Blocks between translation and tilt vanish by symmetry; moments feel the mesh more.
      const double share = moments != slopes ? 1e-10 : (moments ? 12e-3 : 5e-3);
      EXPECT_NEAR(e.coefficients.stiffness[i][j], K[i][j], share * k) << i << j;
      EXPECT_NEAR(e.coefficients.damping[i][j], B[i][j], share * b) << i << j;
      if (moments || slopes) continue;
      EXPECT_NEAR(e.coefficients.stiffness[i][j], K96[i][j], 1e-4 * k);
      EXPECT_NEAR(e.coefficients.damping[i][j], B96[i][j], 1e-3 * b);
    }
}

// Damping falls with the frequency; at low frequency stiffness is that of the film whose pressure follows at once.
TEST(Gas, CoefficientsOverTheFrequency) {
  const Gas o = aerostatic(2, 6e5, {48, 16});
  double before = 1e9;
  for (const double nu : {0.05, 1.0, 3.0, 5.0}) {
    const Equilibrium e = equilibrium(o, 49.05, 2000.0, nu * 2000.0);
    EXPECT_LT(e.coefficients.damping[0][0], before);
    before = e.coefficients.damping[0][0];
    EXPECT_NEAR(before, nu == 0.05 ? 941.0 : nu == 1.0 ? 868.0 : nu == 3.0 ? 547.0 : 319.0, 0.01 * 868.0) << nu;
  }
  Gas at_once = o;
  at_once.states = States::condensed;
  const Equilibrium slow = equilibrium(o, 49.05, 2000.0, 1e-2);
  const auto film = make_film(spindle(), at_once, air());
  Response r;
  film->evaluate(slow.at.motion, Need::tangents, r);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      EXPECT_NEAR(slow.coefficients.stiffness[i][j], -r.d_position[i][j], 1e-6 * 11e6);
}

}  // namespace
}  // namespace whirl::film::testing
