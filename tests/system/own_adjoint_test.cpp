// Sweeps backwards: transposed products and solutions of cycles with own states of films, and a flip by the minimally
// augmented system.

#include <gtest/gtest.h>

#include <cmath>

#include "support/half_rotor.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"
#include "whirl/solve/branch/continuation.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Joining = solve::CycleOptions::Joining;

namespace {

constexpr double clearance = 25e-6, omega_0 = 160;

// Half a rotor on one compliant short bearing, F0* = 1, a* = 0.2 (van de Vrande 2001, sec. 5.3).
system::Train train(int cells, double liner_damping) {
  film::CompliantShort film;
  film.compliance = 0.1;
  film.reference_speed = omega_0;
  film.cells = {cells, 4};
  film.differences = film::Compliant::Differences::central;
  film.liner_damping = liner_damping;
  return test::half_rotor(film, 0.2 * clearance);
}

struct Cycles {
  Cycles(int cells, Joining joining, double at, double liner_damping = 0)
      : system(PETSC_COMM_SELF, train(cells, liner_damping), at) {
    solve::CycleOptions o;
    o.degree = 3;
    o.joining = joining;
    o.state_weight = std::pow(32 / 0.5, 2);
    problem = std::make_unique<solve::CycleProblem>(MPI_COMM_WORLD, system, o, solve::uniform_mesh(24));
    solve::Cycle guess{problem->mesh(), MatrixXd(system.size(), 72), 2 * M_PI / at, at};
    VectorXd x = VectorXd::Zero(system.size());
    x(2) = -0.2;
    x.tail(system.own_states()).setOnes();
    for (Eigen::Index k = 0; k < 72; ++k) guess.x.col(k) = problem->state_scale().cwiseProduct(x);
    u = problem->scatter(guess);
    row = core::duplicate(u.get());
    solve::parameter_row(*problem, row.get());
    newton.max_iterations = 40;
    const auto result = solve::newton(*problem, u.get(), row.get(), at, newton);
    EXPECT_TRUE(result.converged) << result.reason;
    problem->linearise(u.get(), row.get());
  }
  system::RotorSystem system;
  std::unique_ptr<solve::CycleProblem> problem;
  core::Vector u, row;
  solve::NewtonOptions newton;
};

core::Vector generic(const solve::ExtendedProblem& problem, double phase) {
  core::Vector v = problem.make_unknown();
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(v.get(), &begin, nullptr));
  const core::WriteArray a(v.get());
  for (PetscInt i = 0; i < a.size(); ++i) a[i] = 0.3 * std::sin(phase + 1.7 * static_cast<double>(begin + i));
  return v;
}

double dot(Vec a, Vec b) {
  double value = 0;
  core::check(VecDot(a, b, &value));
  return value;
}

}  // namespace

TEST(OwnAdjoint, TransposedProductsAndSolutions) {
  for (const auto& [joining, liner_damping] :
       {std::pair{Joining::sweeps, 0.0}, {Joining::dense, 0.0}, {Joining::sweeps, 0.3 / omega_0}}) {
    Cycles c(20, joining, 4 * omega_0, liner_damping);
    (void)c.problem->multipliers();
    const Eigen::Index n = c.system.size();
    MatrixXd v(n, 3), w(n, 3);
    for (Eigen::Index k = 0; k < 3; ++k)
      for (Eigen::Index i = 0; i < n; ++i) {
        v(i, k) = std::sin(1.3 * static_cast<double>(i) + static_cast<double>(k));
        w(i, k) = std::cos(0.7 * static_cast<double>(i) - static_cast<double>(k));
      }
    solve::Composition& m = c.problem->composition();
    const MatrixXd forward = m.times(v), back = m.times_transposed(w);
    const double size = forward.norm() * w.norm();
    EXPECT_GT(size, 0.1);
    EXPECT_LE((w.transpose() * forward - back.transpose() * v).cwiseAbs().maxCoeff(), 1e-12 * size);

    // y . K^-1 x = x . K^-T y
    const core::Vector x = generic(*c.problem, 1), y = generic(*c.problem, 2), row = generic(*c.problem, 0.4);
    core::Vector a = core::duplicate(x.get()), b = core::duplicate(x.get());
    c.problem->linearise(c.u.get(), row.get());
    c.problem->solve(x.get(), a.get());
    c.problem->solve_transposed(y.get(), b.get());
    EXPECT_NEAR(dot(y.get(), a.get()), dot(x.get(), b.get()), 1e-8 * std::abs(dot(y.get(), a.get())));

    // Second derivatives by products with the structure's blocks, against those by whole matrices.
    const core::Vector along = generic(*c.problem, 4), weight = generic(*c.problem, 5);
    solve::CycleOptions plain = c.problem->options();
    plain.use_structure = false;
    plain.joining = Joining::dense;
    solve::CycleProblem whole(MPI_COMM_WORLD, c.system, plain, c.problem->mesh());
    c.problem->curvature(c.u.get(), along.get(), weight.get(), a.get());
    whole.curvature(c.u.get(), along.get(), weight.get(), b.get());
    double norm = 0, apart = 0;
    core::check(VecNorm(b.get(), NORM_2, &norm));
    core::check(VecAXPY(a.get(), -1, b.get()));
    core::check(VecNorm(a.get(), NORM_2, &apart));
    EXPECT_GT(norm, 1);
    EXPECT_LE(apart, 1e-7 * norm);
  }
}

// The gradient of a flip's condition, by sweeps, against differences of its values; the same null vectors as by LU.
TEST(OwnAdjoint, GradientOfAFlip) {
  VectorXd values[2];
  for (const auto joining : {Joining::sweeps, Joining::dense}) {
    Cycles c(20, joining, 4.2 * omega_0);
    const auto condition = solve::make_flip(*c.problem);
    const core::Vector d = generic(*c.problem, 0.8);
    const auto at = [&](double h) {
      core::Vector moved = core::duplicate(c.u.get());
      core::check(VecWAXPY(moved.get(), h, d.get(), c.u.get()));
      c.problem->linearise(moved.get(), c.row.get());
      return condition->values(moved.get(), {});
    };
    VectorXd& value = values[joining == Joining::dense ? 1 : 0];
    // Borders start differently; they become the singular vectors, and the value the singular value but for its sign.
    for (int k = 0; k < 8; ++k) {
      (void)at(0);
      condition->update();
    }
    value = at(0);
    MatrixXd d_inner;
    std::vector<core::Vector> gradients;
    condition->derivatives(c.u.get(), {}, d_inner, gradients);
    const double h = 1e-5, exact = dot(gradients[0].get(), d.get()), difference = (at(h)(0) - at(-h)(0)) / (2 * h);
    EXPECT_GT(std::abs(exact), 1e-4);
    EXPECT_NEAR(difference, exact, 1e-5 * std::max(1.0, std::abs(exact)));
  }
  EXPECT_NEAR(std::abs(values[0](0)), std::abs(values[1](0)), 1e-10);
}

TEST(OwnAdjoint, FlipByTheAugmentedSystemAndByFalsePosition) {
  double found[2] = {0, 0};
  for (const bool augmented : {false, true}) {
    Cycles c(60, Joining::cheapest, 4.1 * omega_0);
    EXPECT_FALSE(c.problem->composition().has_monodromy());
    solve::ContinuationOptions o;
    o.from = 4.1 * omega_0;
    o.to = 4.4 * omega_0;
    o.initial_step = o.max_step = 16;
    o.adapt_every = 0;
    o.location_tolerance = 1e-9;
    solve::BranchCallbacks callbacks;
    callbacks.cycles = true;
    callbacks.stability = [&](Vec) {
      return solve::make_stability(c.problem->multipliers(), [](auto mu) { return std::abs(mu) - 1; });
    };
    if (augmented)
      callbacks.refine = [&](const solve::LocatedEvent& e, Vec u, Vec t) {
        return solve::refine(*c.problem, e, u, t, c.newton);
      };
    int flips = 0;
    callbacks.on_event = [&](const solve::LocatedEvent& e, Vec) {
      if (e.event != solve::Event::flip) return;
      ++flips;
      EXPECT_EQ(e.refined, augmented);
      found[augmented ? 1 : 0] = e.parameter;
    };
    core::Vector u = core::duplicate(c.u.get());
    core::check(VecCopy(c.u.get(), u.get()));
    (void)solve::follow_branch(*c.problem, std::move(u), o, callbacks);
    EXPECT_EQ(flips, 1);
  }
  EXPECT_NEAR(found[0], found[1], 1e-8 * found[0]);
  EXPECT_NEAR(found[1] / omega_0, 4.29, 0.05);
}
