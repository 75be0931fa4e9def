// A rotor on a film of gas whose lines are shared out over the ranks.

#include <gtest/gtest.h>

#include "film/gas_cases.hpp"
#include "support/half_rotor.hpp"
#include "whirl/core/error.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/newton.hpp"
#include "whirl/system/start.hpp"

using namespace whirl;

namespace {

constexpr double speed = 2000;

system::Train on_gas(int rows) {
  system::Train t = test::half_rotor(film::testing::aerostatic(rows, 6e5, {48, 16}), 0);
  t.rotor.mass = 5;
  t.rotor.load = 49.05;
  t.supports[0].geometry = film::testing::spindle();
  t.supports[0].lubricant = film::testing::air();
  return t;
}

struct Found {
  std::vector<double> state;
  int steps;
};

Found equilibrium(MPI_Comm comm, int rows) {
  system::RotorSystem s(comm, on_gas(rows), speed);
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions options;
  options.searches = false;
  const solve::NewtonResult found = solve::find_equilibrium(s, x.get(), options);
  EXPECT_TRUE(found.converged) << found.reason;
  return {s.gather(x.get()), found.iterations};
}

TEST(GasFilm, RanksFindTheSameEquilibrium) {
  for (const int rows : {1, 2}) {
    const Found here = equilibrium(MPI_COMM_SELF, rows), shared = equilibrium(MPI_COMM_WORLD, rows);
    EXPECT_EQ(shared.steps, here.steps);
    EXPECT_LE(here.steps, 6);
    ASSERT_EQ(shared.state.size(), here.state.size());
    for (std::size_t k = 0; k < here.state.size(); ++k)
      EXPECT_NEAR(shared.state[k], here.state[k], 1e-9 * std::abs(here.state[k]) + 1e-14) << k;
  }
}

TEST(GasFilm, ASearchThatCrawlsGivesUp) {
  system::RotorSystem s(MPI_COMM_WORLD, on_gas(1), speed);
  s.set_forcing(false);
  solve::NewtonOptions options;
  options.max_iterations = 30;
  options.patience = 4;
  core::Vector x = system::static_guess(s);
  const solve::NewtonResult found = solve::find_equilibrium(s, x.get(), options);
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.iterations, 4);
}

}  // namespace
