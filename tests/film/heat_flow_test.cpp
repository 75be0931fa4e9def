// The flow of films with heat is that of films of one temperature: turbulence and cavities.
#include <gtest/gtest.h>

#include <cmath>

#include "film/cases.hpp"
#include "whirl/thermal/film_flow.hpp"

namespace whirl::film::testing {
namespace {

// Load and power loss of a whole turbulent film by the equations of the thermal room and by this room's. The former has
// the mean thickness of two nodes at a face, the latter the exact one: they meet with the square of the spacing.
class LawsOfBoth : public ::testing::TestWithParam<Turbulence> {};
INSTANTIATE_TEST_SUITE_P(Turbulence, LawsOfBoth,
                         ::testing::Values(Turbulence::laminar, Turbulence::constantinescu, Turbulence::ng_pan));

TEST_P(LawsOfBoth, LoadAndPowerLossMeet) {
  const Geometry g = cylinder();
  const double speed = 6000, e[2] = {0.3 * g.clearance, -0.5 * g.clearance};  // Re 3800 of the clearance
  double load[2] = {}, power[2] = {};
  for (const int k : {0, 1}) {
    const int around = 64 << k, along = 16 << k;
    thermal::Mesh mesh;
    mesh.around = around;
    mesh.along = along;
    mesh.across = 2;
    mesh.radius = g.radius;
    mesh.length = g.length;
    const thermal::Rows rows(mesh, PETSC_COMM_SELF);
    thermal::FilmFlowOptions o;
    o.fluid.viscosity = thermal::ConstantViscosity{oil().viscosity};
    o.fluid.density = oil().density;
    o.speed = speed;
    o.turbulence = GetParam();
    std::vector<double> h;
    for (int j = 0; j <= along; ++j)
      for (int i = 0; i < around; ++i)
        h.push_back(g.clearance - e[0] * std::cos(mesh.theta(i)) - e[1] * std::sin(mesh.theta(i)));
    thermal::FilmFlow flow(rows, o, h);
    flow.set_temperature(std::vector<double>(2 * h.size(), 313));
    (void)flow.solve();
    const thermal::FlowReport r = flow.report(flow.flow());

    Reynolds here;
    here.cavitation = Reynolds::Cavitation::none;
    here.turbulence = GetParam();
    here.cells = {around, along};
    const auto film = make_film(g, here, oil());
    const JournalMotion m{{e[0], e[1], 0, 0}, {}, speed};
    const Response found = evaluate(*film, m);
    const double size = std::hypot(found.force[0], found.force[1]);
    load[k] = std::hypot(r.force[0] - found.force[0], r.force[1] - found.force[1]) / size;
    power[k] = std::abs(r.power / film->summary(m, {}).power_loss - 1);
  }
  EXPECT_LT(load[1], 2e-3);
  EXPECT_LT(power[1], 2e-3);
  EXPECT_NEAR(std::log2(load[0] / load[1]), 2, 0.2);
  EXPECT_GT(std::log2(power[0] / power[1]), 1.8);
}

// A film of the same thickness everywhere has no error of the mesh: its shear is the same to rounding.
TEST_P(LawsOfBoth, PowerLossOfAConcentricFilmIsTheSame) {
  const Geometry g = cylinder();
  thermal::Mesh mesh;
  mesh.around = 24;
  mesh.along = 8;
  mesh.across = 3;
  mesh.radius = g.radius;
  mesh.length = g.length;
  const thermal::Rows rows(mesh, PETSC_COMM_SELF);
  thermal::FilmFlowOptions o;
  o.fluid.viscosity = thermal::ConstantViscosity{oil().viscosity};
  o.fluid.density = oil().density;
  o.speed = 6000;
  o.turbulence = GetParam();
  const std::vector<double> h(static_cast<std::size_t>(9 * 24), g.clearance);
  thermal::FilmFlow flow(rows, o, h);
  flow.set_temperature(std::vector<double>(3 * h.size(), 313));
  (void)flow.solve();
  Reynolds here;
  here.cavitation = Reynolds::Cavitation::none;
  here.turbulence = GetParam();
  here.cells = {24, 8};
  const JournalMotion m{{}, {}, 6000};
  EXPECT_NEAR(flow.report(flow.flow()).power / make_film(g, here, oil())->summary(m, {}).power_loss, 1, 1e-12);
}

// A bearing with a groove at its widest gap, whose cavity keeps its oil: load and power loss of both rooms. Loads meet
// with the square of the spacing. The power of a cavity is summed over faces in one room and over nodes in the other.
TEST(CavitiesOfBoth, MeetWithTheMesh) {
  const Geometry g = cylinder();
  const double speed = 300, e = 0.7 * g.clearance;
  double load[3] = {}, power[3] = {};
  for (const int k : {0, 1, 2}) {
    const int around = 40 << k, along = 8 << k, half = 2 << k;
    thermal::Mesh mesh;
    mesh.around = around;
    mesh.along = along;
    mesh.across = 1;
    mesh.radius = g.radius;
    mesh.length = g.length;
    const thermal::Rows rows(mesh, PETSC_COMM_SELF);
    thermal::FilmFlowOptions o;
    o.fluid.viscosity = thermal::ConstantViscosity{oil().viscosity};
    o.fluid.density = oil().density;
    o.speed = speed;
    o.cavitation = thermal::FilmFlowOptions::Cavitation::mass_conserving;
    o.feeds.push_back({around / 2 - half, around / 2 + half, 1, along - 1, 5e4});
    std::vector<double> h;
    for (int j = 0; j <= along; ++j)
      for (int i = 0; i < around; ++i) h.push_back(g.clearance - e * std::cos(mesh.theta(i)));
    thermal::FilmFlow flow(rows, o, h);
    flow.set_temperature(std::vector<double>(h.size(), 313));
    (void)flow.solve();
    const thermal::FlowReport r = flow.report(flow.flow());
    double content = 0;
    for (std::size_t node = 0; node < h.size(); ++node) content += flow.fill()[node] / static_cast<double>(h.size());

    Reynolds here;
    here.cavitation = Reynolds::Cavitation::mass_conserving;
    here.cells = {around, along};
    here.grooves.push_back({std::numbers::pi, 4 * half * std::numbers::pi / around, 5e4});
    const auto film = make_film(g, here, oil());
    const JournalMotion m{{e, 0, 0, 0}, {}, speed};
    const Response found = evaluate(*film, m);
    load[k] = std::hypot(r.force[0] - found.force[0], r.force[1] - found.force[1]) /
              std::hypot(found.force[0], found.force[1]);
    power[k] = std::abs(r.power / film->summary(m, {}).power_loss - 1);
    EXPECT_LT(content, 0.9);
  }
  EXPECT_LT(load[2], 3e-4);
  EXPECT_LT(power[2], 1e-2);
  for (const int k : {0, 1}) {
    EXPECT_GT(std::log2(load[k] / load[k + 1]), 1.8);
    EXPECT_GT(std::log2(power[k] / power[k + 1]), 0.8);
  }
}

}  // namespace
}  // namespace whirl::film::testing
