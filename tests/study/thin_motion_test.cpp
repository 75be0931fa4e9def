// Steps in time by the structure of a machine against assembled ones: the same motions to the tolerance of Newton's
// method.

#include <gtest/gtest.h>

#include <numbers>

#include "film/gas_cases.hpp"
#include "support/finite_rotor.hpp"
#include "support/train_system.hpp"
#include "whirl/transient/steps/integrator.hpp"

using namespace whirl;

namespace {

struct Moved {
  Eigen::VectorXd state;
  double growth = 0;
  long steps = 0;
};

// A quarter of a turn from a place beside the equilibrium, with one deviation.
Moved move(const system::Train& train, const problem::Drive& drive, transient::Algebra algebra, bool deviation) {
  system::RotorSystem s(PETSC_COMM_SELF, train, drive.speed);
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions newton;
  newton.max_iterations = 60;
  core::require(solve::find_equilibrium(s, x.get(), newton).converged, "no equilibrium");
  s.set_forcing(true);
  s.set_acceleration(drive.acceleration);
  transient::Integrator integrator(s, drive, x.get(), {.tolerance = 1e-6, .algebra = algebra});
  transient::Tangents tangents(integrator.scaled(), 1);
  if (deviation) integrator.carry(&tangents);
  for (int k = 1; k <= 4; ++k) integrator.advance(drive.time_of(std::numbers::pi / 8 * k));
  const core::ReadArray a(integrator.scaled());
  return {Eigen::Map<const Eigen::VectorXd>(a.data(), a.size()), deviation ? tangents.orthonormalise()[0] : 0,
          integrator.work().steps};
}

void same(const system::Train& train, const problem::Drive& drive, bool deviation) {
  const Moved thin = move(train, drive, transient::Algebra::automatic, deviation),
              whole = move(train, drive, transient::Algebra::assembled, deviation);
  EXPECT_EQ(thin.steps, whole.steps);
  EXPECT_LT((thin.state - whole.state).cwiseAbs().maxCoeff(), 1e-6 * whole.state.cwiseAbs().maxCoeff());
  EXPECT_NEAR(thin.growth, whole.growth, 1e-4);
}

}  // namespace

TEST(ThinMotion, OfTheTrainRunningUp) {
  auto train = test::train({24, 8}, true);
  test::add_gen_pair(train, 2.5);
  same(train, {300, 0}, true);
  same(train, {300, 400}, false);
}

TEST(ThinMotion, OfACompliantBearing) {
  same(test::finite_rotor(16, 8), {160, 0}, true);
}

TEST(ThinMotion, OfARotorOnGas) {
  system::Train t = test::half_rotor(film::testing::aerostatic(1, 6e5, {32, 8}), 2e-6);
  t.rotor.mass = 5;
  t.rotor.load = 49.05;
  t.supports[0].geometry = film::testing::spindle();
  t.supports[0].lubricant = film::testing::air();
  same(t, {2000, 0}, true);
}
