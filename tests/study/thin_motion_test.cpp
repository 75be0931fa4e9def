// Steps in time by the structure of a machine against assembled ones: the same motions to the tolerance of Newton's
// method.

#include <gtest/gtest.h>

#include <cstdlib>
#include <numbers>

#include "film/gas_cases.hpp"
#include "support/finite_rotor.hpp"
#include "support/train_system.hpp"
#include "transient/steps/sdirk_steps.hpp"
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

long allocations = 0;

}  // namespace

// The C library's own, counted. Eigen and operator new both come here.
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}

TEST(ThinMotion, StepsAllocateNothing) {
  auto train = test::train({24, 8}, true);
  test::add_gen_pair(train, 2.5);
  constexpr double speed = 300, length = 2 * std::numbers::pi / speed / 200;
  system::RotorSystem s(PETSC_COMM_SELF, train, speed);
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  ASSERT_TRUE(solve::find_equilibrium(s, x.get(), {.max_iterations = 60}).converged);
  s.set_forcing(true);
  transient::Equations equations(s, {speed, 0});
  core::Vector u = equations.make_state();
  equations.scale(x.get(), u.get());
  const solve::Tableau tableau = solve::sdirk(4);
  transient::SdirkSteps steps(equations, tableau, 1e-3);
  const auto take = [&](int first, int count) {
    for (int k = first; k < first + count; ++k) EXPECT_EQ(steps.step(k * length, length, u.get()).length, length);
  };
  take(0, 3);  // factors, work space
  const long before = allocations;
  EXPECT_GT(before, 1000);
  take(3, 20);
  EXPECT_EQ(allocations, before);
}

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
