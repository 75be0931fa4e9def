// Limit cycles of shafts that are not reduced, by time modes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/train_system.hpp"
#include "system/start.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/solve/bifurcation/nearest_eigenvalues.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using Joining = solve::CycleOptions::Joining;

namespace {

struct Answer {
  solve::NewtonResult newton;
  solve::Cycle cycle;
  std::vector<double> y;  // peak to peak of each bearing
  std::vector<std::complex<double>> multipliers;
};

Answer cycle_of(MPI_Comm comm, const system::Train& t, double speed, Joining joining, int intervals, int wanted = 24) {
  system::RotorSystem s(PETSC_COMM_SELF, t, speed);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  EXPECT_TRUE(solve::find_equilibrium(s, x.get(), newton).converged);
  solve::CycleOptions o;
  o.joining = joining;
  o.multipliers = wanted;
  solve::CycleProblem p(comm, s, o, solve::uniform_mesh(intervals));
  const auto whole = s.gather(x.get());
  const solve::Cycle guess{p.mesh(),
                           Eigen::Map<const Eigen::VectorXd>(whole.data(), s.size()).replicate(1, intervals * o.degree),
                           2 * M_PI / speed, speed};
  core::Vector u = p.scatter(guess), row = core::duplicate(u.get());
  solve::parameter_row(p, row.get());
  Answer a;
  a.newton = solve::newton(p, u.get(), row.get(), speed, newton);
  EXPECT_TRUE(a.newton.converged) << a.newton.reason << " " << a.newton.residual;
  p.linearise(u.get(), row.get());
  a.multipliers = p.multipliers();
  a.cycle = p.gather(u.get());
  for (std::size_t b = 0; b < t.supports.size(); ++b) {
    double low = 1e9, high = -1e9;
    for (int k = 0; k < 720; ++k) {
      const double at = s.journals(a.cycle.at(p.scheme(), k / 720.0).data())[b].position[1];
      low = std::min(low, at);
      high = std::max(high, at);
    }
    a.y.push_back(high - low);
  }
  return a;
}

// The HP rotor and what hangs beyond its second bearing: 53 nodes, 432 states.
system::Train short_train() {
  system::Train t = test::train({30, 8}, false);
  t.rotor.segments.resize(52);
  t.supports.resize(2);
  t.unbalance = {{25, 0.02, 0}, {35, 0.02, 1}};
  return t;
}

}  // namespace

// Multipliers that the search returns are those of the dense matrix in their order: none is missing. The search
// ends with as many as were asked for, and those that converged beside them, where more lie near the circle.
TEST(WholeShaft, TimeModesAndDenseTransitionsFindTheSameCycle) {
  const system::Train t = short_train();
  constexpr double speed = 350;
  constexpr int intervals = 16;
  const Answer modes = cycle_of(MPI_COMM_WORLD, t, speed, Joining::cheapest, intervals),
               few = cycle_of(MPI_COMM_WORLD, t, speed, Joining::cheapest, intervals, 4),
               dense = cycle_of(MPI_COMM_WORLD, t, speed, Joining::dense, intervals);
  EXPECT_EQ(modes.newton.iterations, dense.newton.iterations);
  EXPECT_LE((modes.cycle.x - dense.cycle.x).cwiseAbs().maxCoeff(), 1e-8 * dense.cycle.x.cwiseAbs().maxCoeff());
  EXPECT_EQ(dense.multipliers.size(), 432U);
  EXPECT_GE(few.multipliers.size(), 4U);
  EXPECT_LT(few.multipliers.size(), modes.multipliers.size());
  for (const Answer* a : {&modes, &few})
    for (std::size_t k = 0; k < a->multipliers.size() && std::abs(a->multipliers[k]) > 0.2; ++k)
      EXPECT_NEAR(std::abs(a->multipliers[k]), std::abs(dense.multipliers[k]), 1e-7) << k;
}

// The whole train at 3600 rpm: 740 freedoms of the shaft, 1500 states. Reference values:
// tests/reference/turbine_train/whole_shaft.json.
TEST(WholeShaft, TrainAtServiceSpeed) {
  auto t = test::train({60, 16}, false);
  test::add_gen_pair(t, 2.5);
  const Answer a = cycle_of(MPI_COMM_WORLD, t, 120 * M_PI, Joining::cheapest, 40);
  EXPECT_LE(a.newton.iterations, 6);
  EXPECT_LE(a.newton.linear_iterations, 3 * a.newton.iterations);
  const double y[] = {26.71e-6, 32.53e-6, 19.86e-6, 3.348e-6, 25.72e-6};
  for (std::size_t b = 0; b < 5; ++b) EXPECT_NEAR(a.y[b], y[b], 0.01 * y[b]) << b;
}

// From the modes of both reductions the search finds those of the whole shaft. Reference: the independent computation
// in tests/reference/turbine_train. Craig-Bampton's errors are the smaller ones.
TEST(WholeShaft, EigenvaluesNextToThoseOfReducedShafts) {
  constexpr double speed = 377;
  const system::Train whole_train = test::train({120, 24}, false);
  system::RotorSystem whole(PETSC_COMM_SELF, whole_train, speed);
  const std::complex<double> reference[] = {
      {-0.58344247, 81.678244}, {-1.9989577, 105.89431}, {-3.7948633, 147.23537}, {-6.7011103, 186.53935}};
  double errors[2] = {0, 0};
  Eigen::ArrayXcd found[2];
  for (const int k : {0, 1}) {
    system::Train t = test::train({120, 24}, true);
    if (k == 1) t.rotor.reduction = {rotor::Reduction::Type::craig_bampton, {6, 49, 93, 160, 181}, 16};
    system::RotorSystem s(PETSC_COMM_SELF, t, speed);
    core::Vector x = system::static_guess(s);
    solve::NewtonOptions newton;
    newton.max_iterations = 40;
    ASSERT_TRUE(solve::find_equilibrium(s, x.get(), newton).converged);
    spectral::EigenOptions o;
    o.shapes = false;
    const auto modes = spectral::modes(s, x.get(), o);
    Eigen::ArrayXcd starts(4);
    for (Eigen::Index i = 0; i < 4; ++i)
      starts(i) = std::min_element(modes.begin(), modes.end(), [&](const auto& a, const auto& b) {
                    return std::abs(a.lambda - reference[i]) < std::abs(b.lambda - reference[i]);
                  })->lambda;
    problem::Films films;
    s.structure()->films(s.structure()->c() * Eigen::Map<const Eigen::VectorXd>(s.gather(x.get()).data(), s.size()),
                         nullptr, nullptr, true, films);
    found[k] = solve::nearest_eigenvalues(whole, films.d_inputs, starts);
    errors[k] = (found[k] - starts).abs().maxCoeff();
    for (Eigen::Index i = 0; i < 4; ++i) EXPECT_LE(std::abs(found[k](i) - reference[i]), 0.05) << reference[i];
  }
  EXPECT_LE((found[0] - found[1]).abs().maxCoeff(), 1e-4);
  EXPECT_GT(errors[0], 1e-3);
  EXPECT_LE(errors[1], 0.1 * errors[0]) << errors[0] << " " << errors[1];
}
