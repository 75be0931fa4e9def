// Machines on films that offer inverses of their own beside films that offer none: these are factorised.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "support/at_rest.hpp"
#include "support/counts_matrices.hpp"
#include "support/half_rotor.hpp"
#include "support/petsc_options.hpp"
#include "support/stage_equations.hpp"
#include "support/train_system.hpp"
#include "whirl/solve/newton/machine_modes.hpp"

using namespace whirl;
using core::check;

namespace {

// What stands under the first, third and fifth journal of the reduced train; short films under the others. Or a rigid
// rotor whose ring of finite length two ranks cut where it offers nothing, before its last line; beside it a pad.
enum class Own { vcycle, exact, both, cut };

film::CompliantShort short_film() {
  film::CompliantShort film;
  film.compliance = 0.05;
  film.reference_speed = 377;
  film.cells = {12, 5};
  film.differences = film::Compliant::Differences::central;
  return film;
}

system::Train cut_ring() {
  film::CompliantFinite ring;
  ring.compliance = 0.1;
  ring.reference_speed = 160;
  ring.cells = {12, 4};
  ring.differences = film::Compliant::Differences::central;
  system::Train t = test::half_rotor(ring, 0);
  system::Support pad = t.supports[0];
  pad.geometry.type = film::Geometry::Bore::partial_arc;
  pad.geometry.arc = 160 * std::numbers::pi / 180;
  pad.film = film::Reynolds{};
  test::hold_content(pad.film);
  film::as<film::Reynolds>(pad.film).cells = {11, 6};
  t.supports.push_back(pad);
  t.supports[0].name = "B1";
  t.supports[1].name = "B2";
  return t;
}

system::Train mix(Own own) {
  if (own == Own::cut) return cut_ring();
  system::Train t = test::train_on_liners({12, 5}, 0.05);
  const system::Train pads = test::train({24, 6}, true);
  for (std::size_t b = 0; b < t.supports.size(); ++b) {
    system::Support& s = t.supports[b];
    if (b % 2 == 1) {
      s.film = short_film();
    } else if (own == Own::exact || (own == Own::both && b == 2)) {
      s.geometry = pads.supports[b].geometry;
      s.film = pads.supports[b].film;
      test::hold_content(s.film);
    }
  }
  return t;
}

std::vector<double> heights(system::RotorSystem& s) {
  std::vector<double> out;
  for (const auto& j : s.journals(s.gather(test::equilibrium(s).get()).data())) out.push_back(j.position[1]);
  return out;
}

class MixedFilms : public ::testing::TestWithParam<Own> {
protected:
  static bool exact() {
    return GetParam() == Own::exact || (GetParam() == Own::cut && core::size_of(MPI_COMM_WORLD) == 2);
  }
};

TEST_P(MixedFilms, HaveAnInverse) {
  system::RotorSystem s(MPI_COMM_WORLD, mix(GetParam()), 377);
  const auto inverse = s.make_part_inverse();
  ASSERT_TRUE(inverse);
  EXPECT_EQ(inverse->exact() != nullptr, exact()) << s.own_states(0) << " and " << s.own_states(1) << " states";
  // Where no film offers one there is none: MUMPS takes all films at once.
  system::Train none = mix(GetParam());
  for (system::Support& at : none.supports) {
    at.geometry.type = film::Geometry::Bore::cylindrical;
    at.geometry.arc = at.geometry.preload = 0;
    at.film = short_film();
  }
  system::RotorSystem without(MPI_COMM_WORLD, none, 377);
  EXPECT_FALSE(without.make_part_inverse());
}

TEST_P(MixedFilms, CarryTheSameEquilibriumHoweverItIsSolved) {
  test::CountsMatrices s(MPI_COMM_WORLD, mix(GetParam()), 377);
  const std::vector<double> found = heights(s);
  if (exact()) {
    EXPECT_EQ(s.made, 0);  // by the inverses alone
  }
  system::RotorSystem alone(MPI_COMM_SELF, mix(GetParam()), 377), assembled(MPI_COMM_WORLD, mix(GetParam()), 377);
  const std::vector<double> by_one = heights(alone);
  const test::WithOptions options(test::by_mumps());
  const std::vector<double> by_mumps = heights(assembled);
  for (std::size_t b = 0; b < found.size(); ++b) {
    EXPECT_LT(found[b], 0) << b;
    EXPECT_NEAR(found[b], by_one[b], 1e-12) << b;
    EXPECT_NEAR(found[b], by_mumps[b], 1e-12) << b;
  }
}

TEST_P(MixedFilms, StagesAreSolvedByTheirInverses) {
  system::RotorSystem s(MPI_COMM_WORLD, mix(GetParam()), 377);
  const core::Vector x = test::equilibrium(s);
  test::expect_stage_is_solved(s, x.get(), 3e-5, 1e-7);
}

// Elimination by exact inverses, also that of the transpose.
TEST(MixedExactFilms, AreEliminatedByTheirInverses) {
  system::RotorSystem s(MPI_COMM_WORLD, mix(Own::exact), 377);
  const core::Vector x = test::equilibrium(s);
  test::StageEquations equations(s, x.get());
  const auto elimination = equations.elimination(1, 40);
  const core::Matrix a = equations.matrix(1, 40);
  const core::Vector v = equations.some(1.3);
  core::Vector b = core::duplicate(v.get()), y = core::duplicate(v.get());
  for (const bool transposed : {false, true}) {
    if (transposed) {
      check(MatMultTranspose(a.get(), v.get(), b.get()));
      elimination->solve_transposed(b.get(), y.get());
    } else {
      check(MatMult(a.get(), v.get(), b.get()));
      elimination->solve(b.get(), y.get());
    }
    EXPECT_LE((test::dense(y.get()) - test::dense(v.get())).lpNorm<Eigen::Infinity>(), 1e-8) << transposed;
  }
}

TEST_P(MixedFilms, HaveTheModesOfTheirWholeMatrix) {
  system::RotorSystem s(MPI_COMM_WORLD, mix(GetParam()), 377);
  const core::Vector x = test::equilibrium(s);
  spectral::EigenOptions o;
  o.count = 8;
  o.dense_below = 0;
  const auto parts = solve::machine_modes(s, x.get(), o).modes;
  const test::WithOptions::List lu = {{"-modes_st_pc_type", "lu"}, {"-modes_st_pc_factor_mat_solver_type", "mumps"}};
  const test::WithOptions options(lu);
  const auto whole = solve::machine_modes(s, x.get(), o).modes;
  ASSERT_EQ(parts.size(), whole.size());
  for (std::size_t k = 0; k < parts.size(); ++k)
    EXPECT_LT(std::abs(parts[k].lambda - whole[k].lambda), 1e-9 * std::abs(whole[k].lambda)) << whole[k].lambda;
}

std::string name_of(const ::testing::TestParamInfo<Own>& which) {
  constexpr std::array names = {"vcycle", "exact", "both", "cut"};
  return names[static_cast<std::size_t>(which.param)];
}

INSTANTIATE_TEST_SUITE_P(Kinds, MixedFilms, ::testing::Values(Own::vcycle, Own::exact, Own::both, Own::cut), name_of);

}  // namespace
