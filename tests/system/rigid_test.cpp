// A rigid rotor in two films on pedestals: derivatives, loads and groups.

#include <gtest/gtest.h>

#include <cmath>

#include "system/start.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/dimensionless_groups.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

system::Train rigid_rotor() {
  system::Train t;
  t.rotor.type = rotor::Options::Type::rigid;
  t.rotor.mass = 20;
  t.rotor.load = 50;
  system::Support s;
  s.node = 1;
  s.geometry = {film::Geometry::Bore::cylindrical, 0.02, 0.03, 5e-5, 0, 0, 0};
  s.film = film::FiniteApproximate{};
  s.lubricant = {0.01, 850};
  s.has_pedestal = true;
  s.mass = {3, 4};
  s.stiffness = {2e7, 3e7};
  s.damping = {2e3, 3e3};
  t.supports = {s, s};
  t.unbalance = {{1, 2e-4, 0.3}};
  return t;
}

}  // namespace

TEST(RigidRotor, DerivativesPassTheTaylorTest) {
  system::RotorSystem s(MPI_COMM_WORLD, rigid_rotor(), 300);
  ASSERT_EQ(s.size(), 12);
  core::Vector x = system::static_guess(s), rate = core::duplicate(x.get());
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(x.get(), &begin, nullptr));
  {
    const core::WriteArray r(rate.get());
    for (PetscInt i = 0; i < r.size(); ++i) r[i] = 1e-3 * std::sin(3.7 * static_cast<double>(begin + i));
  }
  const auto r = problem::taylor_test(s, 0.7, x.get(), rate.get(), 1e-3);
  EXPECT_GT(r.first_difference, 1e-6);
  EXPECT_GE(r.state_order, 1.9);
  EXPECT_GE(r.rate_order, 1.9);
  EXPECT_GE(r.parameter_order, 1.9);
}

TEST(RigidRotor, TwoBearingsShareWeightAndLoad) {
  system::RotorSystem s(MPI_COMM_WORLD, rigid_rotor(), 300);
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions o;
  o.max_iterations = 40;
  ASSERT_TRUE(solve::find_equilibrium(s, x.get(), o).converged);
  const auto whole = s.gather(x.get());
  const auto films = s.film_responses(whole.data(), film::Need::force);
  for (const auto& f : films) {
    EXPECT_NEAR(f.force[0], 0, 1e-6);
    EXPECT_NEAR(f.force[1], (20 * 9.81 + 50) / 2, 1e-6);
  }
  const auto shaft = s.shaft(whole.data(), 0, true);
  ASSERT_EQ(shaft.size(), 4U);
  EXPECT_EQ(shaft[1], whole[2]);
  EXPECT_EQ(shaft[3], 0);
}

TEST(RigidRotor, UnbalanceTurnsWithTheShaft) {
  system::RotorSystem s(MPI_COMM_WORLD, rigid_rotor(), 300);
  EXPECT_NEAR(s.forcing_cosine()[0], 2e-4 * std::cos(0.3), 1e-18);
  EXPECT_NEAR(s.forcing_sine()[0], -2e-4 * std::sin(0.3), 1e-18);
  EXPECT_NEAR(s.forcing_cosine()[2], 2e-4 * std::sin(0.3), 1e-18);
  EXPECT_NEAR(s.forcing_sine()[2], 2e-4 * std::cos(0.3), 1e-18);
}

TEST(RigidRotor, GroupsNeedEqualBearings) {
  system::Train t = rigid_rotor();
  const auto g = system::dimensionless_groups(t);
  ASSERT_TRUE(g.has_value());
  const double load = 20 * 9.81 + 50, scale = std::sqrt(load / (20 * 5e-5));
  EXPECT_NEAR(g->speed_scale, scale, 1e-12 * scale);
  EXPECT_NEAR(g->load, 2.5e-3 * 2.5e-3 * load / (0.01 * scale * 0.03 * 0.04), 1e-12);
  EXPECT_NEAR(g->unbalance, 0.2, 1e-12);
  EXPECT_NEAR(g->sommerfeld(2 * scale), g->load / 4, 1e-12);
  t.supports[1].geometry.clearance *= 1.1;
  EXPECT_FALSE(system::dimensionless_groups(t).has_value());
}
