// A flexible rotor in films with own states: shared out over the ranks, and solved by block elimination or by what the
// options say.

#include <gtest/gtest.h>

#include "support/petsc_options.hpp"
#include "support/train_system.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using core::check;

namespace {

// The reduced train in cylindrical bores of its clearances with soft liners.
system::Train on_liners() {
  system::Train t = test::train({12, 5}, true);
  for (system::Support& s : t.supports) {
    s.name = "B" + std::to_string(&s - t.supports.data() + 1);
    s.geometry = {
        film::Geometry::Bore::cylindrical, s.geometry.radius, s.geometry.length, s.geometry.clearance, 0, 0, 0};
    s.film = {};
    s.film.kind = film::Options::Kind::compliant_finite;
    s.film.compliance = 0.05;
    s.film.reference_speed = 377;
    s.film.cells = {12, 5};
  }
  return t;
}

// Journals a third of a clearance below the middle of their bearings, films at rest there.
core::Vector state_of(system::RotorSystem& s) {
  core::Vector x = core::make_vector(s.comm(), s.local_size(), PETSC_DETERMINE);
  if (core::rank_of(s.comm()) == 0)
    for (int b = 0; b < s.n_bearings(); ++b) {
      const system::Support& at = s.train().supports[static_cast<std::size_t>(b)];
      check(VecSetValue(x.get(), 2 * s.journal(b, 1), at.elevation - at.geometry.clearance / 3, INSERT_VALUES));
    }
  check(VecAssemblyBegin(x.get()));
  check(VecAssemblyEnd(x.get()));
  s.relax_films(x.get());
  return x;
}

std::vector<double> residual_of(system::RotorSystem& s) {
  core::Vector x = state_of(s), rest = core::duplicate(x.get()), f = core::duplicate(x.get());
  check(VecSet(rest.get(), 0));
  s.residual(0.3, x.get(), rest.get(), f.get());
  return s.gather(f.get());
}

// Heights of the journals above their bearings [m] at rest, and how many iterations of GMRES the solution took.
std::vector<double> heights(MPI_Comm comm, int* iterations = nullptr) {
  system::RotorSystem s(comm, on_liners(), 377);
  core::Vector x = s.guess();
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  const auto result = solve::find_equilibrium(s, x.get(), newton);
  EXPECT_TRUE(result.converged) << result.reason;
  if (iterations) *iterations = result.linear_iterations;
  std::vector<double> out;
  for (const auto& j : s.journals(s.gather(x.get()).data())) out.push_back(j.position[1]);
  return out;
}

}  // namespace

TEST(SharedFilms, EveryRankHoldsItsShare) {
  system::RotorSystem s(MPI_COMM_WORLD, on_liners(), 377);
  const auto fields = s.fields();
  ASSERT_EQ(fields.size(), 6U);
  EXPECT_EQ(fields.front().name, "machine");
  PetscInt own = 0;
  for (std::size_t f = 1; f < fields.size(); ++f) own += fields[f].end - fields[f].begin;
  const auto share = static_cast<double>(s.own_states()) / core::size_of(MPI_COMM_WORLD);
  EXPECT_NEAR(static_cast<double>(own), share, 6);  // whole lines of 6 states
  EXPECT_EQ(fields.front().end > 0, core::rank_of(MPI_COMM_WORLD) == 0);
}

TEST(SharedFilms, HaveTheEquationsOfOneRank) {
  system::RotorSystem shared(MPI_COMM_WORLD, on_liners(), 377), whole(MPI_COMM_SELF, on_liners(), 377);
  const std::vector<double> a = residual_of(shared), b = residual_of(whole);
  ASSERT_EQ(a.size(), b.size());
  double largest = 0;
  for (const double v : b) largest = std::max(largest, std::abs(v));
  EXPECT_GT(largest, 1e3);  // the journals are far from where the weight would put them
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-10 * largest) << k;
  core::Vector x = state_of(shared), rates = core::duplicate(x.get());
  check(VecSet(rates.get(), 0));
  const auto taylor = problem::taylor_test(shared, 0.3, x.get(), rates.get(), 1e-5);
  EXPECT_GT(taylor.state_order, 1.9);
  EXPECT_GT(taylor.rate_order, 1.9);
  EXPECT_GT(taylor.parameter_order, 1.9);
}

TEST(SharedFilms, CarryTheSameEquilibriumHoweverItIsSolved) {
  int exact = 0, tried = 0;
  const std::vector<double> alone = heights(MPI_COMM_SELF), elimination = heights(MPI_COMM_WORLD, &exact);
  test::WithOptions::List split = {{"-newton_pc_type", "fieldsplit"},
                                   {"-newton_pc_fieldsplit_type", "multiplicative"},
                                   {"-newton_fieldsplit_border_pc_type", "jacobi"},
                                   {"-newton_ksp_max_it", "100"}};
  for (const std::string field : {"machine", "B1", "B2", "B3", "B4", "B5"}) {
    split.emplace_back("-newton_fieldsplit_" + field + "_pc_type", "lu");
    split.emplace_back("-newton_fieldsplit_" + field + "_pc_factor_mat_solver_type", "mumps");
  }
  const auto with = [&](test::WithOptions::List options) {
    const test::WithOptions chosen(std::move(options));
    return heights(MPI_COMM_WORLD, &tried);
  };
  const std::vector<double> by_fields = with(split);
  EXPECT_GT(tried, exact);  // blocks one after another are no solution
  const std::vector<double> by_mumps = with(test::by_mumps());
  for (std::size_t b = 0; b < alone.size(); ++b) {
    EXPECT_LT(alone[b], 0) << b;
    for (const auto* other : {&elimination, &by_fields, &by_mumps}) EXPECT_NEAR((*other)[b], alone[b], 1e-12) << b;
  }
}

// Which nodes are full changes along every step from the guess: between settled points films are far out of balance.
TEST(ContentFilms, TrainComesToRestInFewSteps) {
  for (const std::array<int, 2> cells : {std::array{30, 8}, {60, 16}}) {
    system::Train t = test::train(cells, true);
    for (system::Support& s : t.supports) {
      s.film.cavitation = film::Options::Cavitation::mass_conserving;
      s.film.states = film::Options::States::dynamic;
    }
    system::RotorSystem s(MPI_COMM_WORLD, t, 377);
    core::Vector x = s.guess();
    solve::NewtonOptions newton;
    newton.max_iterations = 10;
    const auto result = solve::find_equilibrium(s, x.get(), newton);
    EXPECT_TRUE(result.converged) << cells[0] << ": " << result.reason;
  }
}
