#pragma once
// A cycle at given speed, found from the rest.

#include <gtest/gtest.h>

#include <complex>

#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/solve/newton/newton.hpp"

namespace whirl::test {

struct SolvedCycle {
  solve::Cycle cycle;
  std::vector<std::complex<double>> multipliers;
  int iterations = 0;
};

/// At the scaled parameter of `problem`, a PeriodicProblem, from the resting state of `rest` at all times.
template <class Problem>
SolvedCycle solved(Problem& problem, const solve::Cycle& rest, double parameter, solve::NewtonOptions newton) {
  solve::Cycle guess = rest;
  guess.mesh = problem.mesh();
  guess.x = rest.x.replicate(1, guess.intervals() * problem.scheme().degree);
  core::Vector u = problem.scatter(guess), row = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  const auto r = solve::newton(problem, u.get(), row.get(), parameter, newton);
  EXPECT_TRUE(r.converged) << r.reason << " " << r.residual;
  problem.linearise(u.get(), row.get());
  return {problem.gather(u.get()), problem.multipliers(), r.iterations};
}

}  // namespace whirl::test
