// Loads that stand still: forces and moments on nodes, and gravity in any direction.

#include <gtest/gtest.h>

#include "support/varied_machines.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

constexpr double span = 2;  // of the four segments, between the bearings at both ends [m]

// In two linear bearings at its ends.
system::Machine on_springs() {
  system::Machine m;
  m.rotor = test::four_segments();
  for (const int node : {1, 5}) {
    system::Bearing b;
    b.name = node == 1 ? "left" : "right";
    b.node = node;
    b.film = film::Linear{{1e7, 0, 0, 1e7}, {1e3, 0, 0, 1e3}};
    m.bearings.push_back(b);
  }
  return m;
}

struct Rest {
  std::vector<film::Response> bearings;
  std::vector<double> shape;  // x, y, dx/dz, dy/dz of each node
};

Rest rest(const system::Machine& m) {
  system::RotorSystem s(MPI_COMM_WORLD, system::train_of(m), 100);
  const core::Vector x = s.guess();
  EXPECT_TRUE(solve::find_equilibrium(s, x.get(), {}).converged);
  const std::vector<double> whole = s.gather(x.get());
  return {s.film_responses(whole.data(), film::Need::force), s.shaft(x.get(), 0, true)};
}

using Type = rotor::Reduction::Type;

system::Machine reduced(Type type) {
  system::Machine m = on_springs();
  m.rotor.internal_damping = 1e-4;
  m.rotor.reduction.type = type;
  m.rotor.reduction.masters = {1, 5};
  m.rotor.reduction.modes = 2;
  m.rotor.reduction.speed = 100;
  return m;
}

}  // namespace

// The sum of forces and moments about the left bearing is zero.
TEST(StaticLoads, BearingsCarryThem) {
  system::Machine m = on_springs();
  m.gravity = 0.0;
  m.loads = {{2, {100, -2000}, {}}, {3, {}, {{30, -50}}}};
  const Rest r = rest(m);
  const double z = 0.5;  // of node 2
  const auto &left = r.bearings[0].force, &right = r.bearings[1].force;
  EXPECT_NEAR(right[0], -(100 * z + -50) / span, 1e-6);
  EXPECT_NEAR(right[1], -(-2000 * z - 30) / span, 1e-6);
  EXPECT_NEAR(left[0] + right[0], -100, 1e-6);
  EXPECT_NEAR(left[1] + right[1], 2000, 1e-6);
}

// A shaft in round bearings under gravity along x is the one under gravity along -y, turned; at all nodes, those that a
// reduction drops among them.
TEST(StaticLoads, GravityAcrossIsGravityDownTurned) {
  for (const Type type : {Type::none, Type::guyan, Type::craig_bampton, Type::craig_bampton_state}) {
    system::Machine m = reduced(type);
    m.gravity = std::array{0.0, -9.81, 4.0};
    const std::vector<double> down = rest(m).shape;
    m.gravity = std::array{9.81, 0.0, 0.0};
    const std::vector<double> across = rest(m).shape;
    ASSERT_GT(std::abs(down[4 * 2 + 1]), 1e-5);
    for (std::size_t i = 0; i < down.size(); i += 2) {
      EXPECT_NEAR(across[i], -down[i + 1], 1e-9 * std::abs(down[4 * 2 + 1]));
      EXPECT_NEAR(across[i + 1], down[i], 1e-9 * std::abs(down[4 * 2 + 1]));
    }
  }
}

TEST(StaticLoads, GravityAlongTheShaftLoadsNothing) {
  system::Machine m = on_springs();
  m.bearings[0].pedestal = system::Pedestal{{50, 60}, {4e8, 5e8}, {3e4, 2e4}};
  m.gravity = std::array{0.0, 0.0, -9.81};
  for (const double u : rest(m).shape) EXPECT_EQ(u, 0);
}

// Slopes that a moment turns are kept by a reduction: the shaft bends as the whole one does.
TEST(StaticLoads, MomentsOnReducedShafts) {
  system::Machine m = on_springs();
  m.loads = {{3, {0, -500}, {{400, 0}}}};
  const std::vector<double> whole = rest(m).shape;
  m.rotor.reduction = {Type::guyan, {1, 3, 5}, 0};
  const std::vector<double> guyan = rest(m).shape;
  ASSERT_EQ(whole.size(), guyan.size());
  for (std::size_t i = 0; i < whole.size(); ++i) EXPECT_NEAR(guyan[i], whole[i], 1e-10);
}
