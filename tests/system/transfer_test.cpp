// Machines on films with states: transfer functions against the films' own coefficients, eigenvalues from them against
// the whole pencil.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "solve/newton/transfer_modes.hpp"
#include "support/at_rest.hpp"
#include "support/film_of.hpp"
#include "support/half_rotor.hpp"
#include "support/petsc_options.hpp"
#include "support/train_system.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"
#include "whirl/solve/newton/machine_modes.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/spectral/whirl.hpp"

using namespace whirl;
using Complex = std::complex<double>;
using film::testing::Kind;

namespace {

constexpr double clearance = 25e-6, scale = 160;

// Half a rotor on one bearing, L/D = 1.
system::Train rigid(Kind kind, std::array<int, 2> cells, double compliance) {
  film::testing::Elastic film;
  film.kind = kind;
  film.compliance = compliance;
  film.reference_speed = scale;
  film.cells = cells;
  system::Train t = test::half_rotor(film, 0);
  t.supports[0].name = "B1";
  t.unbalance.clear();
  return t;
}

// A liner of damped rubber, whose force depends on the rates of its states.
system::Train damped() {
  system::Train t = rigid(Kind::compliant_short, {40, 4}, 0.3);
  auto& film = film::as<film::Compliant>(t.supports[0].film);
  film.liner_damping = 0.3 / scale;
  film.rubber_thickness = 4 * clearance;
  return t;
}

system::Train content() {
  system::Train t = rigid(Kind::compliant_short, {24, 6}, 0.1);
  film::Reynolds film;
  film.cavitation = film::Reynolds::Cavitation::mass_conserving;
  film.states = film::Reynolds::States::dynamic;
  film.cells = {24, 6};
  film.grooves = {{1.57, 0.3}};
  t.supports[0].film = film;
  return t;
}

// Half the load on a film with an inverse of its own, the other half on one without.
system::Train mix() {
  system::Train t = content();
  t.rotor.load *= 2;
  t.rotor.mass *= 2;
  t.supports.push_back(damped().supports[0]);
  t.supports[1].name = "B2";
  return t;
}

// A V-cycle beside an exact inverse.
system::Train mix_with_finite() {
  system::Train t = mix();
  t.supports[1] = rigid(Kind::compliant_finite, {20, 6}, 0.1).supports[0];
  t.supports[1].name = "B2";
  return t;
}

// Of a film by itself, by elimination of its states on one rank.
film::Coefficients coefficients_alone(const system::RotorSystem& s, int b, const std::vector<double>& x, double omega) {
  std::vector<std::unique_ptr<film::Film>> films;
  auto begin = x.end() - s.own_states();
  for (const system::Support& at : s.train().supports) {
    films.push_back(film::make_film(at.geometry, at.film, at.lubricant));
    if (&at - s.train().supports.data() < b) begin += static_cast<std::ptrdiff_t>(films.back()->states());
  }
  const system::JournalState journal = s.journals(x.data())[static_cast<std::size_t>(b)];
  film::JournalMotion motion;
  for (std::size_t d = 0; d < 2; ++d) motion.position[d] = journal.position[d];
  motion.speed = s.speed();
  film::Film& film = *films[static_cast<std::size_t>(b)];
  return film::coefficients(film, motion, {&*begin, film.states()}, omega);
}

bool within(Complex z, const solve::TransferOptions& o) {
  const double centre = (o.frequency - o.decay) / 2, along = (o.frequency + o.decay) / 2;
  return std::hypot((z.real() - centre) / along, z.imag() / o.frequency) < 1;
}

// All eigenvalues in the region, of those of the whole pencil at x.
void expect_those_within(system::RotorSystem& s, Vec x, const std::vector<spectral::Mode>& whole,
                         const solve::TransferOptions& o, int at_least) {
  std::vector<spectral::Mode> expected;
  int number = 0;
  for (const auto& m : whole)
    if (within(m.lambda, o)) {
      number += m.lambda.imag() != 0 ? 2 : 1;
      expected.push_back(m);
    }
  EXPECT_GE(static_cast<int>(expected.size()), at_least);
  const auto found = solve::transfer_modes(s, x, o);
  EXPECT_EQ(found.doubt, "");
  EXPECT_EQ(found.counted, number);
  EXPECT_EQ(found.missed, 0);
  ASSERT_EQ(found.modes.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_LT(std::abs(found.modes[k].lambda - expected[k].lambda), 1e-10 * o.frequency) << expected[k].lambda;
    EXPECT_NEAR(spectral::mac(found.modes[k].shape, expected[k].shape), 1, 1e-6) << expected[k].lambda;
  }
}

}  // namespace

// From the motion of the journal to minus the force on it, with what a film does at constant states.
TEST(FrequencyResolvent, HoldsTheCoefficientsOfItsFilms) {
  for (const auto& train : {rigid(Kind::compliant_finite, {20, 6}, 0.1), damped(), content(), mix(),
                            test::train_on_liners({12, 5}, 0.05)}) {
    system::RotorSystem s(MPI_COMM_WORLD, train, train.supports.size() > 2 ? 377 : 2 * scale);
    const core::Vector x = test::equilibrium(s);
    solve::FrequencyResolvent transfer(s);
    transfer.linearise(x.get());
    const auto whole = s.gather(x.get());
    const auto direct = s.film_responses(whole.data(), film::Need::tangents);
    const double omega = 0.47 * s.speed();
    const auto h = transfer.evaluate({0, omega}, false);
    for (int b = 0; b < s.n_bearings(); ++b) {
      const auto expected = coefficients_alone(s, b, whole, omega);
      const auto& film = direct[static_cast<std::size_t>(b)];
      const std::vector<PetscInt> position{2 * s.journal(b, 0), 2 * s.journal(b, 1)},
          rate{position[0] + 1, position[1] + 1};
      const auto part = static_cast<std::size_t>(b);
      const Eigen::MatrixXcd by_states = transfer.from_motion(part, h[part], {0, omega}, position, rate, position);
      const double size = std::abs(Complex(expected.stiffness[0], omega * expected.damping[0]));
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j) {
          const Complex at_constant_states(film.d_position[i][j], omega * film.d_velocity[i][j]);
          const Complex sum =
              by_states(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) - at_constant_states;
          EXPECT_LT(std::abs(sum - Complex(expected.stiffness[2 * i + j], omega * expected.damping[2 * i + j])),
                    1e-9 * size)
              << s.train().supports[part].name << i << j;
        }
    }
  }
}

// Two journals on finite films, whose own inverses are V-cycles.
system::Train two_finite() {
  system::Train t = rigid(Kind::compliant_finite, {20, 6}, 0.1);
  t.rotor.load *= 2;
  t.rotor.mass *= 2;
  t.supports.push_back(rigid(Kind::compliant_finite, {16, 8}, 0.05).supports[0]);
  t.supports[1].name = "B2";
  return t;
}

// At rest, at and beyond the speed of whirl, growing and decaying: by iterations as by factors, with slopes.
TEST(FrequencyResolvent, IteratesOnApproximateInversesOfLargeFilms) {
  for (const auto& train : {two_finite(), mix_with_finite()}) {
    system::RotorSystem s(MPI_COMM_WORLD, train, 2.4 * scale);
    const core::Vector x = test::equilibrium(s);
    solve::FrequencyResolvent factors(s);
    factors.linearise(x.get());
    EXPECT_FALSE(factors.iterates());
    const test::WithOptions large(test::WithOptions::List{{"-parts_kept_states", "0"}});
    solve::FrequencyResolvent iterations(s);
    iterations.linearise(x.get());
    std::vector<Complex> places = {{0, 0.47}, {-0.1, 3}};
    if (core::size_of(MPI_COMM_WORLD) == 1) places.insert(places.end(), {{0, 0}, {0.05, 0.5}, {0, 30}});
    for (const Complex at : places) {
      const Complex lambda = at * s.speed();
      const auto expected = factors.evaluate(lambda, true), found = iterations.evaluate(lambda, true);
      ASSERT_TRUE(iterations.iterates()) << lambda;
      ASSERT_EQ(found.size(), train.supports.size());
      for (std::size_t b = 0; b < found.size(); ++b) {
        EXPECT_LT((found[b].value - expected[b].value).norm(), 1e-10 * expected[b].value.norm()) << lambda << b;
        EXPECT_LT((found[b].slope - expected[b].slope).norm(), 1e-10 * expected[b].slope.norm()) << lambda << b;
      }
    }
  }
}

// Where iterations end too early, films are factorised if the machine is small enough; else all ranks say why.
TEST(FrequencyResolvent, FactorisesWhereIterationsFailOrSaysWhy) {
  system::RotorSystem s(MPI_COMM_WORLD, two_finite(), 2.4 * scale);
  const core::Vector x = test::equilibrium(s);
  const Complex lambda{0, s.speed()};
  solve::FrequencyResolvent factors(s);
  factors.linearise(x.get());
  const auto expected = factors.evaluate(lambda, true);
  const test::WithOptions early(test::WithOptions::List{{"-parts_kept_states", "0"}, {"-frequency_ksp_max_it", "2"}});
  solve::FrequencyResolvent either(s);
  either.linearise(x.get());
  const auto found = either.evaluate(lambda, true);
  EXPECT_FALSE(either.iterates());
  for (std::size_t b = 0; b < found.size(); ++b)
    EXPECT_LT((found[b].slope - expected[b].slope).norm(), 1e-10 * expected[b].slope.norm());
  const test::WithOptions small(test::WithOptions::List{{"-parts_whole_states", "100"}});
  solve::FrequencyResolvent refused(s);
  refused.linearise(x.get());
  try {
    (void)refused.evaluate(lambda, false);
    FAIL() << "two iterations were enough";
  } catch (const core::NotConverged& error) {
    EXPECT_NE(std::string(error.what()).find("2 iterations"), std::string::npos) << error.what();
  }
}

// The same of equilibria.
TEST(Equilibrium, OfALargeMachineIsNotFactorisedWhereIterationsFail) {
  system::RotorSystem s(MPI_COMM_WORLD, two_finite(), 2.4 * scale);
  const core::Vector x = test::equilibrium(s);
  core::Vector guess = core::duplicate(x.get());
  core::check(VecCopy(x.get(), guess.get()));
  s.set_parameter(2.5 * scale);
  const test::WithOptions early(test::WithOptions::List{{"-equilibrium_ksp_max_it", "1"}});
  {
    const test::WithOptions small(test::WithOptions::List{{"-parts_whole_states", "100"}});
    const solve::NewtonResult refused = solve::find_equilibrium(s, guess.get(), {});
    EXPECT_FALSE(refused.converged);
    EXPECT_NE(refused.reason.find("-parts_whole_states"), std::string::npos) << refused.reason;
    EXPECT_NE(refused.reason.find("relative residual"), std::string::npos) << refused.reason;
  }
  core::check(VecCopy(x.get(), guess.get()));
  EXPECT_TRUE(solve::find_equilibrium(s, guess.get(), {}).converged);
  // A tolerance that one iteration meets.
  const test::WithOptions loose(
      test::WithOptions::List{{"-equilibrium_ksp_rtol", "0.9"}, {"-parts_whole_states", "100"}});
  core::check(VecCopy(x.get(), guess.get()));
  const solve::NewtonResult rough = solve::find_equilibrium(s, guess.get(), {});
  EXPECT_EQ(rough.reason.find("-parts_whole_states"), std::string::npos) << rough.reason;
}

// Regions in which films have few eigenvalues of their own, and many.
struct Reach {
  double frequency, decay;
  int at_least;
};

void expect_in(const system::Train& train, double speed, std::initializer_list<Reach> regions) {
  system::RotorSystem s(MPI_COMM_WORLD, train, speed);
  const core::Vector x = test::equilibrium(s);
  spectral::EigenOptions all;
  all.dense_below = s.size();
  const std::vector<spectral::Mode> whole = spectral::modes(s, x.get(), all);
  for (const Reach& r : regions) {
    solve::TransferOptions o;
    o.frequency = r.frequency;
    o.decay = r.decay;
    expect_those_within(s, x.get(), whole, o, r.at_least);
  }
}

TEST(TransferModes, OfAFiniteFilmAreThoseOfTheWholePencil) {
  expect_in(rigid(Kind::compliant_finite, {20, 6}, 0.1), 2.4 * scale,
            {{2 * scale, scale, 1}, {8 * scale, 12 * scale, 3}, {16 * scale, 24 * scale, 4}});
}

TEST(TransferModes, OfADampedLinerAreThoseOfTheWholePencil) {
  expect_in(damped(), 2.0 * scale, {{2 * scale, 2 * scale, 2}});
}

TEST(TransferModes, OfAFilmThatHoldsItsContentAreThoseOfTheWholePencil) {
  expect_in(content(), 2.0 * scale, {{2 * scale, scale, 1}, {3 * scale, 3.4 * scale, 4}});
}

TEST(TransferModes, OfAMixOfFilmsAreThoseOfTheWholePencil) {
  expect_in(mix(), 2.0 * scale, {{2 * scale, scale, 1}});
}

TEST(TransferModes, OfTheTrainOnFiveLinersAreThoseOfTheWholePencil) {
  const system::Train train = test::train_on_liners({12, 5}, 0.05);
  // Many eigenvalues, in the last region with a search that begins anew on smaller circles: one rank decides all of it,
  // and others that wait would take as long again.
  if (core::size_of(MPI_COMM_WORLD) == 1)
    expect_in(train, 377, {{400, 100, 4}, {1000, 500, 8}, {2000, 1000, 10}});
  else
    expect_in(train, 377, {{400, 100, 4}});
}

// Each place of a damped liner has an eigenvalue of its own near -1/tau that the journal hardly sees. They are all
// counted; not all are found, and the answer says so.
TEST(TransferModes, CountThoseThatHideInADampedLiner) {
  system::RotorSystem s(MPI_COMM_WORLD, damped(), 2.0 * scale);
  const core::Vector x = test::equilibrium(s);
  solve::TransferOptions o;
  o.frequency = 8 * scale;
  o.decay = 6 * scale;
  int number = 0, found = 0;
  for (const auto& m : spectral::modes(s, x.get(), {}))
    if (within(m.lambda, o)) number += m.lambda.imag() != 0 ? 2 : 1;
  EXPECT_GT(number, 40);
  const auto modes = solve::transfer_modes(s, x.get(), o);
  EXPECT_EQ(modes.counted, number);
  EXPECT_GE(modes.modes.size(), 1U);
  for (const auto& m : modes.modes) found += m.lambda.imag() != 0 ? 2 : 1;
  EXPECT_EQ(modes.missed, number - found);
}

// The parts of a large machine are eliminated; as one it is factorised if an option says so.
TEST(MachineModes, OfALargeMachineAreThoseOfItsWholeMatrix) {
  system::RotorSystem s(MPI_COMM_WORLD, rigid(Kind::compliant_finite, {48, 14}, 0.1), 2.4 * scale);
  const core::Vector x = test::equilibrium(s);
  spectral::EigenOptions o;
  o.count = 12;
  ASSERT_GT(s.size(), o.dense_below);
  const auto parts = solve::machine_modes(s, x.get(), o).modes;
  core::check(PetscOptionsSetValue(nullptr, "-modes_st_pc_type", "lu"));
  core::check(PetscOptionsSetValue(nullptr, "-modes_st_pc_factor_mat_solver_type", "mumps"));
  const auto whole = solve::machine_modes(s, x.get(), o).modes;
  PetscBool used = PETSC_FALSE;
  core::check(PetscOptionsUsed(nullptr, "modes_st_pc_factor_mat_solver_type", &used));
  EXPECT_TRUE(used);
  core::check(PetscOptionsClearValue(nullptr, "-modes_st_pc_type"));
  core::check(PetscOptionsClearValue(nullptr, "-modes_st_pc_factor_mat_solver_type"));
  ASSERT_EQ(parts.size(), whole.size());
  for (std::size_t k = 0; k < parts.size(); ++k)
    EXPECT_LT(std::abs(parts[k].lambda - whole[k].lambda), 1e-9 * std::abs(whole[k].lambda)) << whole[k].lambda;
}

// Those that do not count are passed by, by either way; where none is left the search says that it gave up.
TEST(MachineModes, AreSoughtUntilEnoughCount) {
  system::RotorSystem s(MPI_COMM_WORLD, rigid(Kind::compliant_finite, {48, 14}, 0.1), 2.4 * scale);
  const core::Vector x = test::equilibrium(s);
  spectral::EigenOptions o;
  o.count = 12;
  double least = 0;  // [rad/s], above that of all those that one search finds
  for (const auto& m : solve::machine_modes(s, x.get(), o).modes) least = std::max(least, m.lambda.imag());
  solve::Wanted wanted;
  wanted.counts = [&](const spectral::Mode& m) { return m.lambda.imag() > 1.01 * least; };
  const auto more = solve::machine_modes(s, x.get(), o, wanted);
  EXPECT_FALSE(more.gave_up);
  EXPECT_TRUE(std::any_of(more.modes.begin(), more.modes.end(), wanted.counts));
  wanted.counts = [](const spectral::Mode&) { return false; };
  for (const char* way : {"whole", "transfer"}) {
    core::check(PetscOptionsSetValue(nullptr, "-modes_by", way));
    EXPECT_TRUE(solve::machine_modes(s, x.get(), o, wanted).gave_up) << way;
  }
  core::check(PetscOptionsClearValue(nullptr, "-modes_by"));
}

TEST(MachineModes, AreFoundTheWayThatIsAskedFor) {
  system::RotorSystem s(MPI_COMM_WORLD, rigid(Kind::compliant_finite, {20, 6}, 0.1), 2.4 * scale);
  const core::Vector x = test::equilibrium(s);
  const auto by = [&](const char* way) {
    if (way) core::check(PetscOptionsSetValue(nullptr, "-modes_by", way));
    return solve::machine_modes(s, x.get(), {});
  };
  const auto least_stable = [](const solve::MachineModes& m) {
    return std::max_element(m.modes.begin(), m.modes.end(),
                            [](const auto& a, const auto& b) { return a.lambda.real() < b.lambda.real(); })
        ->lambda;
  };
  const auto automatic = by(nullptr), whole = by("whole"), transfer = by("transfer");
  EXPECT_FALSE(automatic.transfer);
  EXPECT_FALSE(whole.transfer);
  EXPECT_TRUE(transfer.transfer);
  EXPECT_EQ(transfer.missed, 0);
  EXPECT_LT(std::abs(least_stable(transfer) - least_stable(whole)), 1e-9 * scale);
  EXPECT_LT(transfer.modes.size(), whole.modes.size());
  EXPECT_THROW((void)by("guess"), core::InputError);
  core::check(PetscOptionsClearValue(nullptr, "-modes_by"));
  // Memory that is scarcer: transfer functions for fewer states, and no factors kept.
  core::check(PetscOptionsSetValue(nullptr, "-modes_whole_states", "100"));
  core::check(PetscOptionsSetValue(nullptr, "-parts_kept_states", "100"));
  const auto small = by(nullptr);
  EXPECT_TRUE(small.transfer);
  EXPECT_LT(std::abs(least_stable(small) - least_stable(transfer)), 1e-9 * scale);
  core::check(PetscOptionsClearValue(nullptr, "-modes_whole_states"));
  core::check(PetscOptionsClearValue(nullptr, "-parts_kept_states"));
}
