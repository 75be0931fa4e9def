// Limit cycles of the Guyan-reduced train (film 60 x 16) against the independent harmonic-balance reference.

#include <gtest/gtest.h>

#include <cmath>

#include "support/petsc_options.hpp"
#include "support/train_system.hpp"
#include "system/start.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

struct Answer {
  std::vector<double> y, x;  // peak to peak per bearing
  double multiplier = 0;
  int iterations = 0, linear = 0;
  solve::Cycle cycle;
};

Answer cycle_at(double grade, double speed, const solve::CycleOptions& options, int intervals) {
  auto t = test::train({60, 16}, true);
  test::add_gen_pair(t, grade);
  system::RotorSystem s(PETSC_COMM_SELF, t, speed);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  EXPECT_TRUE(solve::find_equilibrium(s, x.get(), newton).converged);
  solve::CycleProblem p(MPI_COMM_WORLD, s, options, solve::uniform_mesh(intervals));
  solve::Cycle guess{p.mesh(), {}, 2 * M_PI / speed, speed};
  const auto whole = s.gather(x.get());
  guess.x = Eigen::Map<const Eigen::VectorXd>(whole.data(), s.size()).replicate(1, intervals * options.degree);
  core::Vector u = p.scatter(guess), row = core::duplicate(u.get());
  solve::parameter_row(p, row.get());
  const auto r = solve::newton(p, u.get(), row.get(), speed / options.parameter_scale, newton);
  EXPECT_TRUE(r.converged) << r.reason << " " << r.residual;
  p.linearise(u.get(), row.get());
  Answer a;
  a.iterations = r.iterations;
  a.linear = r.linear_iterations;
  a.multiplier = std::abs(spectral::eigenvalues(p.monodromy())[0]);
  a.cycle = p.gather(u.get());
  for (int b = 0; b < s.n_bearings(); ++b) {
    double lo[2] = {1e9, 1e9}, hi[2] = {-1e9, -1e9};
    for (int k = 0; k < 720; ++k) {
      const Eigen::VectorXd z = a.cycle.at(p.scheme(), k / 720.0);
      const auto j = s.journals(z.data())[static_cast<std::size_t>(b)];
      for (std::size_t d = 0; d < 2; ++d) {
        lo[d] = std::min(lo[d], j.position[d]);
        hi[d] = std::max(hi[d], j.position[d]);
      }
    }
    a.x.push_back(hi[0] - lo[0]);
    a.y.push_back(hi[1] - lo[1]);
  }
  return a;
}

}  // namespace

TEST(Cycle, G25AtServiceSpeed) {
  solve::CycleOptions o;
  o.degree = 4;
  const Answer a = cycle_at(2.5, 377, o, 30);
  const double x[] = {73.418986e-6, 57.762367e-6, 34.903346e-6, 12.25791e-6, 63.923153e-6};
  const double y[] = {26.964783e-6, 32.671942e-6, 19.961869e-6, 3.3752351e-6, 25.811979e-6};
  for (std::size_t b = 0; b < 5; ++b) {
    EXPECT_NEAR(a.x[b], x[b], 6e-3 * x[b]);
    EXPECT_NEAR(a.y[b], y[b], 6e-3 * y[b]);
  }
  EXPECT_NEAR(a.multiplier, 0.99000172, 1e-3);
}

TEST(Cycle, AllLinearAlgebraPathsAgree) {
  solve::CycleOptions o;
  const Answer structured = cycle_at(2.5, 377, o, 12);
  o.use_structure = false;
  const Answer dense = cycle_at(2.5, 377, o, 12);
  const test::WithOptions chosen(test::by_mumps());
  const Answer assembled = cycle_at(2.5, 377, o, 12);
  EXPECT_EQ(structured.iterations, dense.iterations);
  EXPECT_LE((structured.cycle.x - dense.cycle.x).cwiseAbs().maxCoeff(), 1e-9 * dense.cycle.x.cwiseAbs().maxCoeff());
  EXPECT_LE((assembled.cycle.x - dense.cycle.x).cwiseAbs().maxCoeff(), 1e-9 * dense.cycle.x.cwiseAbs().maxCoeff());
  EXPECT_NEAR(structured.multiplier, dense.multiplier, 1e-9);
}

// The border by one more Schur step over the orbit, which MUMPS solves.
TEST(Cycle, FieldsAreSplitByOption) {
  solve::CycleOptions o;
  const Answer own = cycle_at(2.5, 377, o, 12);
  const test::WithOptions chosen({{"-newton_pc_type", "fieldsplit"},
                                  {"-newton_pc_fieldsplit_type", "schur"},
                                  {"-newton_fieldsplit_orbit_pc_type", "lu"},
                                  {"-newton_fieldsplit_orbit_pc_factor_mat_solver_type", "mumps"},
                                  {"-newton_fieldsplit_border_pc_type", "none"}});
  const Answer split = cycle_at(2.5, 377, o, 12);
  EXPECT_EQ(own.iterations, split.iterations);
  EXPECT_LE((split.cycle.x - own.cycle.x).cwiseAbs().maxCoeff(), 1e-9 * own.cycle.x.cwiseAbs().maxCoeff());
}
