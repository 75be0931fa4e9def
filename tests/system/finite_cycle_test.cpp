// Cycles of a rigid rotor in a compliant film of finite length by Newton-Picard, whose stages are solved by the system
// itself: the same numbers as dense shooting with the same steps, on any number of ranks.

#include <gtest/gtest.h>

#include <cmath>

#include "support/cycle_rows.hpp"
#include "support/finite_rotor.hpp"
#include "whirl/solve/newton/newton.hpp"
#include "whirl/solve/shooting/newton_picard.hpp"
#include "whirl/solve/shooting/shooting_problem.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

constexpr double speed_scale = test::finite_speed_scale, speed = 4.5 * speed_scale;

// By Newton-Picard, which must be the cycle and the multipliers of dense shooting, of these those that are larger than
// `least`.
solve::Cycle compared(const system::Train& train, int steps = 10, double least = 0) {
  solve::NewtonOptions newton;
  newton.tolerance = 1e-10;
  system::RotorSystem s(MPI_COMM_WORLD, train, speed), alone(PETSC_COMM_SELF, train, speed);
  const solve::Cycle start = test::finite_rotor_at_rest(alone, speed);
  solve::NewtonPicardOptions options;
  options.parameter_scale = speed_scale;
  solve::NewtonPicardProblem picard(s, options, solve::sdirk(4), steps, solve::uniform_mesh(1));
  core::Vector u = picard.scatter(test::rows_of(start, s)), row = core::duplicate(u.get());
  solve::parameter_row(picard, row.get());
  const auto r = solve::newton(picard, u.get(), row.get(), speed / speed_scale, newton);
  EXPECT_TRUE(r.converged) << r.reason;
  picard.linearise(u.get(), row.get());
  const auto mu = picard.multipliers();
  const solve::Cycle cycle = test::whole_of(picard.gather(u.get()), s);

  solve::CycleOptions dense_options;
  dense_options.parameter_scale = speed_scale;
  solve::ShootingProblem dense(PETSC_COMM_SELF, alone, dense_options, solve::sdirk(4), steps, solve::uniform_mesh(1));
  core::Vector v = dense.scatter(start), dense_row = core::duplicate(v.get());
  solve::parameter_row(dense, dense_row.get());
  const auto q = solve::newton(dense, v.get(), dense_row.get(), speed / speed_scale, newton);
  EXPECT_TRUE(q.converged) << q.reason;
  dense.linearise(v.get(), dense_row.get());
  auto exact = spectral::eigenvalues(dense.monodromy());
  const solve::Cycle expected = dense.gather(v.get());
  for (Eigen::Index k = 0; k < cycle.x.rows(); ++k)
    EXPECT_NEAR(cycle.x(k, 0), expected.x(k, 0), 1e-7 * expected.x.cwiseAbs().maxCoeff()) << k;
  EXPECT_GT(std::abs(mu.front()), least);
  for (const auto& m : mu) {
    double nearest = 1;
    for (const auto& e : exact) nearest = std::min(nearest, std::abs(m - e));
    if (std::abs(m) > least) {
      EXPECT_LE(nearest, 1e-6) << m;
    }
  }
  return cycle;
}

}  // namespace

TEST(FiniteFilmCycle, NewtonPicardEqualsDenseShooting) {
  (void)compared(test::finite_rotor(12, 4));
}

// The same with asperities that carry on rubber, at a cycle that they change.
TEST(FiniteFilmCycle, NewtonPicardEqualsDenseShootingInContact) {
  const system::Train without = test::finite_rotor(12, 4);
  system::Train rough = without;
  auto& film = film::as<film::Compliant>(rough.supports[0].film);
  film.contact = film::Contact{0.25 * rough.supports[0].geometry.clearance, 1e8};
  film.rubber_thickness = 4 * rough.supports[0].geometry.clearance;
  const solve::Cycle a = compared(rough);
  film.contact.reset();
  const solve::Cycle b = compared(rough);
  const Eigen::Index states = a.x.rows() - 4;
  EXPECT_GT((a.x - b.x).bottomRows(states).cwiseAbs().maxCoeff(), 0.03 * rough.supports[0].geometry.clearance);
}

// Beside a film that offers no inverse of its own.
TEST(FiniteFilmCycle, NewtonPicardEqualsDenseShootingInAMix) {
  system::Train train = test::finite_rotor(12, 4);
  train.rotor.load *= 2;
  train.rotor.mass *= 2;
  film::CompliantShort film;
  film.compliance = 0.2;
  film.reference_speed = test::finite_speed_scale;
  film.cells = {24, 4};
  film.differences = film::Compliant::Differences::central;
  train.supports.insert(train.supports.begin(), train.supports[0]);
  train.supports[0].film = film;
  train.supports[0].name = "other";
  system::RotorSystem s(MPI_COMM_WORLD, train, speed);
  ASSERT_TRUE(s.make_part_inverse());
  (void)compared(train, 8, 1e-3);
}

// A film that is solved as a whole stands on one rank with the rotor: the others hold no states, and go along.
TEST(FiniteFilmCycle, RanksWithoutStatesGoAlong) {
  constexpr int steps = 2;
  system::Train train = test::finite_rotor(12, 4);
  film::CompliantShort film;
  film.compliance = 0.1;
  film.reference_speed = test::finite_speed_scale;
  film.cells = {12, 4};
  film.differences = film::Compliant::Differences::central;
  train.supports[0].film = film;
  system::RotorSystem s(MPI_COMM_WORLD, train, speed), alone(PETSC_COMM_SELF, train, speed);
  int least = s.local_size();
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  if (core::size_of(MPI_COMM_WORLD) > 1) {
    ASSERT_EQ(least, 0);
  }
  const solve::Cycle start = test::finite_rotor_at_rest(alone, speed);
  solve::NewtonPicardOptions options;
  options.parameter_scale = speed_scale;
  solve::NewtonPicardProblem picard(s, options, solve::sdirk(2), steps, solve::uniform_mesh(1));
  solve::CycleOptions dense_options;
  dense_options.parameter_scale = speed_scale;
  solve::ShootingProblem dense(PETSC_COMM_SELF, alone, dense_options, solve::sdirk(2), steps, solve::uniform_mesh(1));
  const auto linearised = [&](auto& problem, const system::RotorSystem& system) {
    const core::Vector u = problem.scatter(test::rows_of(start, system)), row = core::duplicate(u.get());
    solve::parameter_row(problem, row.get());
    problem.linearise(u.get(), row.get());
    return problem.multipliers().front();
  };
  const auto mu = linearised(picard, s), expected = linearised(dense, alone);
  EXPECT_LE(std::min(std::abs(mu - expected), std::abs(mu - std::conj(expected))), 1e-8);
}
