// A flexible rotor in films with own states: shared out over the ranks, and solved by block elimination or by what the
// options say.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/counts_matrices.hpp"
#include "support/petsc_options.hpp"
#include "support/stage_equations.hpp"
#include "support/train_system.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using core::check;

namespace {

int splits = 0;  // of communicators, in this program

}  // namespace

extern "C" int MPI_Comm_split(MPI_Comm comm, int colour, int key, MPI_Comm* made) {
  ++splits;
  return PMPI_Comm_split(comm, colour, key, made);
}

namespace {

// The reduced train in its own bearings, whose films hold their content.
system::Train on_content() {
  system::Train t = test::train({24, 6}, true);
  for (system::Support& s : t.supports) {
    s.name = "B" + std::to_string(&s - t.supports.data() + 1);
    test::hold_content(s.film);
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

// Own states a little off those, so that none of their rows is zero.
std::vector<double> residual_of(system::RotorSystem& s) {
  core::Vector x = state_of(s), rest = core::duplicate(x.get()), f = core::duplicate(x.get());
  check(VecSet(rest.get(), 0));
  check(VecScale(x.get(), 1.02));
  s.residual(0.3, x.get(), rest.get(), f.get());
  return s.gather(f.get());
}

// Heights of the journals above their bearings [m] at rest, and how many iterations of GMRES the solution took.
std::vector<double> heights(MPI_Comm comm, int* iterations = nullptr,
                            const system::Train& train = test::train_on_liners({12, 5}, 0.05)) {
  system::RotorSystem s(comm, train, 377);
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
  system::RotorSystem s(MPI_COMM_WORLD, test::train_on_liners({12, 5}, 0.05), 377);
  const auto fields = s.fields();
  ASSERT_EQ(fields.size(), 6U);
  EXPECT_EQ(fields.front().name, "machine");
  PetscInt own = 0;
  for (std::size_t f = 1; f < fields.size(); ++f) own += fields[f].end - fields[f].begin;
  const auto share = static_cast<double>(s.own_states()) / core::size_of(MPI_COMM_WORLD);
  EXPECT_NEAR(static_cast<double>(own), share, 6);  // whole lines of 6 states
  EXPECT_EQ(fields.front().end > 0, core::rank_of(MPI_COMM_WORLD) == 0);
  EXPECT_EQ(fields.front().quantity, "");
  const double clearance = s.train().supports[1].geometry.clearance;
  EXPECT_EQ(fields[2].name, "B2");
  EXPECT_EQ(fields[2].quantity, "thickness");
  EXPECT_EQ(fields[2].unit, "m");
  EXPECT_EQ(fields[2].scale, clearance);
  core::Vector states = core::make_vector(s.comm(), s.local_size(), PETSC_DETERMINE),
               rows = core::duplicate(states.get());
  s.scales(states.get(), rows.get());
  const core::ReadArray a(states.get());
  for (PetscInt i = fields[2].begin; i < fields[2].end; ++i) EXPECT_EQ(a[i], clearance);
}

// Films on pads are cut at whole columns, also within a pad.
TEST(SharedFilms, OnPadsAreSharedToo) {
  const system::RotorSystem s(MPI_COMM_WORLD, on_content(), 377);
  const auto fields = s.fields();
  ASSERT_EQ(fields.size(), 6U);
  PetscInt own = 0;
  for (std::size_t f = 1; f < fields.size(); ++f) {
    own += fields[f].end - fields[f].begin;
    EXPECT_EQ(fields[f].quantity, "content");
  }
  EXPECT_NEAR(static_cast<double>(own), static_cast<double>(s.own_states()) / core::size_of(MPI_COMM_WORLD), 3);
}

class SharedFilmsOf : public ::testing::TestWithParam<bool> {};

TEST_P(SharedFilmsOf, HaveTheEquationsOfOneRank) {
  const system::Train train = GetParam() ? on_content() : test::train_on_liners({12, 5}, 0.05);
  system::RotorSystem shared(MPI_COMM_WORLD, train, 377), whole(MPI_COMM_SELF, train, 377);
  const std::vector<double> a = residual_of(shared), b = residual_of(whole);
  ASSERT_EQ(a.size(), b.size());
  double largest = 0;
  for (const double v : b) largest = std::max(largest, std::abs(v));
  EXPECT_GT(largest, 1e3);  // the journals are far from where the weight would put them
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-10 * largest) << k;
  core::Vector x = state_of(shared), rates = core::duplicate(x.get());
  check(VecSet(rates.get(), 0));
  const auto taylor = problem::taylor_test(shared, 0.3, x.get(), rates.get(), 1e-5);
  if (!GetParam()) {  // the other one has kinks where nodes become full
    EXPECT_GT(taylor.state_order, 1.9);
  }
  EXPECT_GT(taylor.rate_order, 1.9);
  EXPECT_GT(taylor.parameter_order, 1.9);
}

// The list of entries is the Jacobian, and no rank tells rows of parts on another one.
TEST_P(SharedFilmsOf, ListTheJacobian) {
  const system::Train train = GetParam() ? on_content() : test::train_on_liners({12, 5}, 0.05);
  system::RotorSystem s(MPI_COMM_WORLD, train, 377);
  core::Vector x = state_of(s), rates = core::duplicate(x.get()), v = core::duplicate(x.get()),
               w = core::duplicate(x.get()), listed = core::duplicate(x.get());
  check(VecSet(rates.get(), 0));
  check(VecSetRandom(v.get(), nullptr));
  const std::vector<double> all = s.gather(v.get());
  core::Matrix j = s.make_jacobian();
  problem::Entries entries;
  PetscInt first = 0, last = 0;
  check(VecGetOwnershipRange(x.get(), &first, &last));
  std::size_t count = 0;
  for (const auto& [alpha, sigma] : {std::pair{1.0, 0.0}, std::pair{0.0, 1.0}, std::pair{0.7, 30.0}}) {
    s.jacobian(0, x.get(), rates.get(), alpha, sigma, j.get());
    check(MatMult(j.get(), v.get(), w.get()));
    ASSERT_TRUE(s.entries(0, x.get(), rates.get(), alpha, sigma, entries));
    ASSERT_EQ(entries.values().size(), entries.places().size());
    if (count > 0) {
      EXPECT_EQ(entries.values().size(), count);  // the same places again
    }
    count = entries.values().size();
    check(VecSet(listed.get(), 0));
    for (std::size_t k = 0; k < count; ++k) {
      const auto [row, column] = entries.places()[k];
      EXPECT_TRUE((row >= first && row < last) || (row < 2 * s.coordinates() && column >= first && column < last));
      check(VecSetValue(listed.get(), row, entries.values()[k] * all[static_cast<std::size_t>(column)], ADD_VALUES));
    }
    check(VecAssemblyBegin(listed.get()));
    check(VecAssemblyEnd(listed.get()));
    const double size = core::norm(w.get());
    EXPECT_GT(size, 0);
    check(VecAXPY(w.get(), -1, listed.get()));
    EXPECT_LT(core::norm(w.get()), 1e-12 * size) << alpha << ' ' << sigma;
  }
}

// Films by their own inverses need no matrix that is assembled; whoever asks for one has it.
TEST(SharedFilms, AreSolvedWithoutAMatrix) {
  test::CountsMatrices s(MPI_COMM_WORLD, on_content(), 377);
  core::Vector x = s.guess();
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  EXPECT_TRUE(solve::find_equilibrium(s, x.get(), newton).converged);
  EXPECT_EQ(s.made, 0);
  solve::FrequencyResolvent transfer(s);
  transfer.linearise(x.get());
  const auto h = transfer.evaluate({0, 377}, false);
  EXPECT_EQ(s.made, 0);
  const auto again = transfer.evaluate({0, 377}, true);
  EXPECT_EQ(s.made, 0);
  for (std::size_t b = 0; b < h.size(); ++b) EXPECT_EQ(h[b].value, again[b].value);
  EXPECT_TRUE(core::Matrix(s.make_jacobian()));
  EXPECT_EQ(s.made, 1);
  // The same by factors.
  const test::WithOptions::List by_factors = {{"-parts_by", "factors"}};
  const test::WithOptions options(by_factors);
  core::Vector by_matrix = s.guess();
  EXPECT_TRUE(solve::find_equilibrium(s, by_matrix.get(), newton).converged);
  const double size = core::norm(x.get());
  check(VecAXPY(by_matrix.get(), -1, x.get()));
  EXPECT_LT(core::norm(by_matrix.get()), 1e-9 * size);
}

// What results show comes from the shares: the same as from the whole state.
TEST_P(SharedFilmsOf, AreSeenAsFromTheWholeState) {
  const system::Train train = GetParam() ? on_content() : test::train_on_liners({12, 5}, 0.05);
  system::RotorSystem s(MPI_COMM_WORLD, train, 377);
  const core::Vector x = state_of(s);
  const system::Observed seen = s.observe(x.get());
  const std::vector<double> whole = s.gather(x.get()), thickness = s.film_thickness(whole.data());
  const auto shown = s.shown(whole.data());
  ASSERT_EQ(seen.shown.size(), 5U);
  ASSERT_EQ(seen.film_thickness.size(), 5U);
  for (std::size_t b = 0; b < 5; ++b) {
    EXPECT_EQ(seen.shown[b].position, shown[b].position);
    EXPECT_EQ(seen.shown[b].velocity, shown[b].velocity);
    EXPECT_EQ(seen.film_thickness[b], thickness[b]);
    EXPECT_LT(thickness[b], train.supports[b].geometry.clearance);
  }
}

// The Jacobian of shares is that of one rank, entry by entry.
TEST_P(SharedFilmsOf, HaveTheJacobianOfOneRank) {
  const system::Train train = GetParam() ? on_content() : test::train_on_liners({12, 5}, 0.05);
  system::RotorSystem shared(MPI_COMM_WORLD, train, 377), whole(MPI_COMM_SELF, train, 377);
  const auto product = [](system::RotorSystem& s) {
    core::Vector x = state_of(s), rest = core::duplicate(x.get()), v = core::duplicate(x.get()),
                 y = core::duplicate(x.get()), rows = core::duplicate(x.get());
    check(VecSet(rest.get(), 0));
    core::Matrix j = s.make_jacobian();
    s.jacobian(0, x.get(), rest.get(), 0.7, 60, j.get());
    s.scales(v.get(), rows.get());
    PetscInt begin = 0;
    check(VecGetOwnershipRange(v.get(), &begin, nullptr));
    {
      const core::WriteArray va(v.get());
      for (PetscInt i = 0; i < va.size(); ++i) va[i] *= std::sin(1.3 * static_cast<double>((begin + i) * (begin + i)));
    }
    check(MatMult(j.get(), v.get(), y.get()));
    check(VecPointwiseDivide(y.get(), y.get(), rows.get()));
    return s.gather(y.get());
  };
  const std::vector<double> a = product(shared), b = product(whole);
  const double largest =
      std::abs(*std::max_element(b.begin(), b.end(), [](double u, double v) { return std::abs(u) < std::abs(v); }));
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-9 * largest) << k;
}

INSTANTIATE_TEST_SUITE_P(Kinds, SharedFilmsOf, ::testing::Bool(),
                         [](const auto& which) { return which.param ? "content" : "liners"; });

// Newton's method settles such films on the way, wherever they stand.
TEST(SharedFilms, OnPadsCarryTheSameEquilibrium) {
  system::Train train;
  train.rotor.type = rotor::Options::Type::rigid;
  train.rotor.mass = 20;
  system::Support support;
  support.node = 1;
  support.geometry = {film::Geometry::Bore::lemon_bore, 0.02, 0.03, 5e-5, 160 * std::numbers::pi / 180, 0.5, 0};
  test::hold_content(support.film);
  film::as<film::Reynolds>(support.film).cells = {40, 10};
  support.lubricant = {0.01, 850};
  train.supports = {support, support};
  const std::vector<double> alone = heights(MPI_COMM_SELF, nullptr, train),
                            shared = heights(MPI_COMM_WORLD, nullptr, train);
  for (std::size_t b = 0; b < alone.size(); ++b) {
    EXPECT_LT(alone[b], 0) << b;
    EXPECT_NEAR(shared[b], alone[b], 1e-12) << b;
  }
}

// Of any rotor in several films with damped liners.
TEST(SharedFilms, StagesAreSolvedByPreconditionersOfTheFilms) {
  system::Train train = test::train_on_liners({12, 5}, 0.05);
  film::as<film::Compliant>(train.supports[3].film).liner_damping = 1e-4;
  system::RotorSystem s(MPI_COMM_WORLD, train, 377);
  core::Vector x = state_of(s);
  test::expect_stage_is_solved(s, x.get(), 3e-5, 1e-7);
}

// Every step that is kept has its inverses; communicators are few.
TEST(SharedFilms, InversesShareTheirCommunicators) {
  std::unique_ptr<problem::PartInverse> last;
  {
    system::RotorSystem s(MPI_COMM_WORLD, test::train_on_liners({12, 5}, 0.05), 377);
    splits = 0;
    const auto first = s.make_part_inverse();
    ASSERT_TRUE(first);
    EXPECT_EQ(splits, 5);  // films
    last = s.make_part_inverse();
    ASSERT_TRUE(last);
    EXPECT_EQ(splits, 5);
  }
  last.reset();
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
  for (auto& [name, value] : split)
    if (const std::size_t at = name.find("_pc_"); name.find("split_B") != std::string::npos)
      name.insert(at, "_thickness");
  split.emplace_back("-newton_split_quantities", "");
  const std::vector<double> by_quantities = with(split);
  const std::vector<double> by_mumps = with(test::by_mumps());
  // Elimination without the films' own preconditioners, and where these do not serve.
  const test::WithOptions::List by_lu = {{"-parts_by", "factors"}}, one = {{"-equilibrium_ksp_max_it", "1"}};
  const std::vector<double> parts_by_lu = with(by_lu), given_up = with(one);
  for (std::size_t b = 0; b < alone.size(); ++b) {
    EXPECT_LT(alone[b], 0) << b;
    for (const auto* other : {&elimination, &by_fields, &by_quantities, &by_mumps, &parts_by_lu, &given_up})
      EXPECT_NEAR((*other)[b], alone[b], 1e-12) << b;
  }
}

// Which nodes are full changes along every step from the guess: between settled points films are far out of balance.
TEST(ContentFilms, TrainComesToRestInFewSteps) {
  for (const std::array<int, 2> cells : {std::array{30, 8}, {60, 16}}) {
    system::Train t = test::train(cells, true);
    for (system::Support& s : t.supports) test::hold_content(s.film);
    system::RotorSystem s(MPI_COMM_WORLD, t, 377);
    core::Vector x = s.guess();
    solve::NewtonOptions newton;
    newton.max_iterations = 10;
    const auto result = solve::find_equilibrium(s, x.get(), newton);
    EXPECT_TRUE(result.converged) << cells[0] << ": " << result.reason;
  }
}
