// A rotor on a film of gas whose lines are shared out over the ranks.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "film/gas_cases.hpp"
#include "support/half_rotor.hpp"
#include "system/start.hpp"
#include "whirl/core/error.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/newton.hpp"

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

// With a pocket at each orifice, deep ones in one row, between nodes.
system::Train on_pockets() {
  system::Train t = on_gas(2);
  auto& gas = film::as<film::Gas>(t.supports[0].film);
  gas.slip = film::Gas::Slip::second;
  gas.orifices[0].law = film::OrificeRow::Law::two_restrictors;
  gas.orifices[0].pocket = film::Pocket{1e-3, 60e-6};
  gas.orifices[1].law = film::OrificeRow::Law::reynolds;
  gas.orifices[1].pocket = film::Pocket{0.6e-3, 15e-6};
  gas.orifices[1].angle = 0.05;
  return t;
}

struct Found {
  std::vector<double> state;
  int steps;
};

Found equilibrium(MPI_Comm comm, const system::Train& train) {
  system::RotorSystem s(comm, train, speed);
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions options;
  options.searches = false;
  const solve::NewtonResult found = solve::find_equilibrium(s, x.get(), options);
  EXPECT_TRUE(found.converged) << found.reason;
  return {s.gather(x.get()), found.iterations};
}

TEST(GasFilm, RanksFindTheSameEquilibrium) {
  for (const system::Train& train : {on_gas(1), on_gas(2), on_pockets()}) {
    const Found here = equilibrium(MPI_COMM_SELF, train), shared = equilibrium(MPI_COMM_WORLD, train);
    EXPECT_EQ(shared.steps, here.steps);
    EXPECT_LE(here.steps, 7);
    ASSERT_EQ(shared.state.size(), here.state.size());
    for (std::size_t k = 0; k < here.state.size(); ++k)
      EXPECT_NEAR(shared.state[k], here.state[k], 1e-9 * std::abs(here.state[k]) + 1e-14) << k;
  }
}

// dF/dp of what studies may vary, against differences of F over two steps.
TEST(GasFilm, DerivativesInItsOptions) {
  const auto gas = [](system::Train& t) -> film::Gas& { return film::as<film::Gas>(t.supports[0].film); };
  const std::vector<std::pair<double, std::function<void(system::Train&, double)>>> options = {
      {6e5, [&](system::Train& t, double p) { gas(t).orifices[0].supply = p; }},
      {0.2e-3, [&](system::Train& t, double p) { gas(t).orifices[1].diameter = p; }},
      {60e-6, [&](system::Train& t, double p) { gas(t).orifices[0].pocket->depth = p; }},
      {101325, [&](system::Train& t, double p) { gas(t).ambient = p; }},
      {300, [&](system::Train& t, double p) { gas(t).temperature = p; }},
      {20e-6, [](system::Train& t, double p) { t.supports[0].geometry.clearance = p; }},
      {1.846e-5, [](system::Train& t, double p) { t.supports[0].lubricant.viscosity = p; }}};
  for (const auto& [value, set] : options) {
    SCOPED_TRACE(value);
    const auto train = [&](double p) {
      system::Train t = on_pockets();
      set(t, p);
      return t;
    };
    system::RotorSystem s(MPI_COMM_WORLD, system::Varying{train, value, value}, speed);
    const core::Vector x = system::static_guess(s);
    const core::Vector rest = core::duplicate(x.get()), by = core::duplicate(x.get());
    core::check(VecSet(rest.get(), 0));
    s.parameter_derivative(0, x.get(), rest.get(), by.get());
    EXPECT_GT(core::norm(by.get()), 0);
    std::array<double, 2> error{};
    for (std::size_t k = 0; k < 2; ++k) {
      const double step = value * (k == 0 ? 4e-3 : 2e-3);
      const core::Vector below = core::duplicate(x.get()), above = core::duplicate(x.get());
      s.set_parameter(value - step);
      s.residual(0, x.get(), rest.get(), below.get());
      s.set_parameter(value + step);
      s.residual(0, x.get(), rest.get(), above.get());
      s.set_parameter(value);
      core::check(VecAXPY(above.get(), -1, below.get()));
      core::check(VecAXPY(above.get(), -2 * step, by.get()));
      error[k] = core::norm(above.get()) / (2 * step * core::norm(by.get()));
    }
    EXPECT_LT(error[1], 1e-3);
    if (error[1] > 1e-7) {
      EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.1);
    }
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
