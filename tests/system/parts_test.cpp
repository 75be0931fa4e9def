// A machine is its parts joined at ports: the rows of the hub alone, and what the films do to them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/overhung.hpp"
#include "support/two_fields.hpp"
#include "system/film_part.hpp"
#include "system/rotor_part.hpp"
#include "whirl/core/error.hpp"

using namespace whirl;
using core::check;

namespace {

// Films that tilt; the second one has states of its own if wanted.
system::Train machine(bool states) {
  system::Train t = test::overhung(true, {24, 6});
  film::Reynolds& second = film::as<film::Reynolds>(t.supports[1].film);
  if (states) {
    second.cavitation = film::Reynolds::Cavitation::mass_conserving;
    second.states = film::States::dynamic;
  }
  return t;
}

// Something smooth of a typical size, the same on any number of ranks.
core::Vector wavy(Vec scale, double factor, double phase) {
  core::Vector x = core::duplicate(scale);
  PetscInt first = 0;
  check(VecGetOwnershipRange(scale, &first, nullptr));
  const core::ReadArray s(scale);
  const core::WriteArray a(x.get());
  for (PetscInt k = 0; k < a.size(); ++k) a[k] = factor * s[k] * std::sin(0.7 * static_cast<double>(first + k) + phase);
  return x;
}

class Parts : public ::testing::TestWithParam<bool> {};

// F of the machine and F of the hub differ by the forces at the ports, and in no other row of the hub; likewise
// dF/dOmega.
TEST_P(Parts, MeetAtPortsAlone) {
  system::RotorSystem s(PETSC_COMM_WORLD, machine(GetParam()), 250.0);
  ASSERT_EQ(s.own_states() > 0, GetParam());
  s.set_acceleration(30.0);
  system::RotorPart hub(s.comm(), s.train(), GetParam() && core::size_of(s.comm()) > 1);
  hub.follow(250.0);
  EXPECT_EQ(hub.coordinates(), s.coordinates());
  core::Vector scale = core::make_vector(s.comm(), s.local_size(), PETSC_DETERMINE),
               rows = core::duplicate(scale.get()), f = core::duplicate(scale.get());
  s.scales(scale.get(), rows.get());
  const core::Vector x = wavy(scale.get(), 0.1, 0.2);
  core::Vector xdot = wavy(scale.get(), 20.0, 1.1);
  {
    // Own states rest, as film_responses() takes them.
    const core::WriteArray a(xdot.get());
    std::fill(a.data() + hub.rows(), a.data() + a.size(), 0.0);
  }
  const std::vector<double> whole = s.gather(x.get());
  const auto films = s.film_responses(whole.data(), film::Need::tangents);
  const system::Instant at{0.4, 250.0, 30.0, true, x.get(), xdot.get()};
  for (const bool speed : {false, true}) {
    std::vector<double> alone(static_cast<std::size_t>(hub.rows()));
    if (speed) {
      s.parameter_derivative(at.angle, at.x, at.xdot, f.get());
      hub.speed_derivative(at, alone.data());
    } else {
      s.residual(at.angle, at.x, at.xdot, f.get());
      hub.residual(at, alone.data());
    }
    double felt = 0.0;
    std::vector<double> forces(static_cast<std::size_t>(2 * s.coordinates()), 0.0);
    for (int b = 0; b < s.n_bearings(); ++b)
      for (int d = 0; d < s.ports(b); ++d) {
        const film::Response& r = films[static_cast<std::size_t>(b)];
        const double force = (speed ? r.d_speed : r.force)[static_cast<std::size_t>(d)];
        felt = std::max(felt, std::abs(force));
        forces[static_cast<std::size_t>(2 * s.journal(b, d))] += force;
        if (d < 2 && s.pedestal(b, d) >= 0) forces[static_cast<std::size_t>(2 * s.pedestal(b, d))] -= force;
      }
    // Here only the second film feels the speed, and that not while it holds its content.
    if (!speed || !GetParam()) {
      EXPECT_GT(felt, speed ? 1e-3 : 1.0) << "N, or N s";
    }
    const core::ReadArray fa(f.get()), ra(rows.get());
    double size = 0.0;
    for (PetscInt i = 0; i < hub.rows(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double force = forces[k + 2 * static_cast<std::size_t>(hub.begin())];
      EXPECT_NEAR(fa[i], alone[k] - force, 1e-9 * (ra[i] + std::abs(alone[k]) + std::abs(force))) << i;
      size = std::max(size, std::abs(alone[k]) / ra[i]);
    }
    MPI_Allreduce(MPI_IN_PLACE, &size, 1, MPI_DOUBLE, MPI_MAX, s.comm());
    EXPECT_GT(size, 1e-5) << "the hub feels something";
  }
}

// The fields of the parts cover every local row once, and each part gives magnitudes for its own.
TEST_P(Parts, FieldsCoverAllRows) {
  system::RotorSystem s(PETSC_COMM_WORLD, machine(GetParam()), 250.0);
  PetscInt next = 0;
  for (const problem::Field& f : s.fields()) {
    EXPECT_EQ(f.begin, next);
    next = f.end;
  }
  EXPECT_EQ(next, s.local_size());
  core::Vector scale = core::make_vector(s.comm(), s.local_size(), PETSC_DETERMINE),
               rows = core::duplicate(scale.get());
  s.scales(scale.get(), rows.get());
  const core::ReadArray a(scale.get()), b(rows.get());
  for (PetscInt i = 0; i < a.size(); ++i) {
    EXPECT_GT(a[i], 0.0);
    EXPECT_GT(b[i], 0.0);
  }
  for (const problem::Field& f : s.fields())
    for (PetscInt i = f.begin; f.scale > 0.0 && i < f.end; ++i) EXPECT_EQ(a[i], f.scale);
}

// Fields of a film differ in unit: rows of a field are measured in what it says, else in its states times 300/s. Also
// where a cut runs through a field.
TEST(FilmParts, MeasureEachFieldInItsOwnUnits) {
  constexpr int n = 4;
  for (const auto& [begin, end] : {std::pair{0, 8}, std::pair{0, 3}, std::pair{3, 8}, std::pair{5, 8}}) {
    system::FilmPart part(std::make_unique<test::TwoFields>(n), 0);
    part.hold(begin, end, 2, 0, false);
    ASSERT_EQ(part.rows(), end - begin);
    const auto fields = part.fields("film");
    ASSERT_EQ(fields.size(), 2U);
    EXPECT_EQ(fields[0].begin, 2);
    EXPECT_EQ(fields[0].end, fields[1].begin);
    EXPECT_EQ(fields[1].end, 2 + end - begin);
    std::vector<double> states(static_cast<std::size_t>(end - begin)), rows = states;
    part.scales(states.data(), rows.data());
    for (int k = begin; k < end; ++k) {
      const auto i = static_cast<std::size_t>(k - begin);
      EXPECT_EQ(states[i], k < n ? 50 : 1e-5) << k;
      EXPECT_EQ(rows[i], k < n ? 50 * 2e7 : 1e-5 * 300) << k;
    }
  }
}

// A film that is cut through all its fields numbers them slab by slab.
TEST(FilmParts, HoldTheirPieceOfFieldsThatComeAgain) {
  for (const auto& [begin, end] : {std::pair{0, 8}, std::pair{0, 2}, std::pair{2, 8}, std::pair{4, 4}}) {
    system::FilmPart part(std::make_unique<test::TwoFields>(4, true), 0);
    part.hold(begin, end, 3, 0, false);
    const auto fields = part.fields("film");
    ASSERT_EQ(fields.size(), 2U);
    std::vector<int> seen(static_cast<std::size_t>(end - begin), -1);
    for (int q = 0; q < 2; ++q)
      fields[static_cast<std::size_t>(q)].each([&](PetscInt i) { seen.at(static_cast<std::size_t>(i - 3)) = q; });
    std::vector<double> states(seen.size()), rows(seen.size());
    part.scales(states.data(), rows.data());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      EXPECT_EQ(seen[i], static_cast<int>(i % 2)) << i;
      EXPECT_EQ(states[i], i % 2 == 0 ? 50 : 1e-5) << i;
      EXPECT_EQ(rows[i], i % 2 == 0 ? 50 * 2e7 : 1e-5 * 300) << i;
    }
    const auto whole = problem::parts_of(fields);
    ASSERT_EQ(whole.size(), 1U);
    EXPECT_EQ(whole[0].begin, 3);
    EXPECT_EQ(whole[0].end, 3 + end - begin);
    EXPECT_EQ(whole[0].quantity, "");
  }
}

INSTANTIATE_TEST_SUITE_P(Machines, Parts, ::testing::Bool(),
                         [](const auto& which) { return which.param ? "with_states" : "without_states"; });

}  // namespace
