// Films that tilt in symmetric machines, where they must not, and on cycles by every way of linear algebra.

#include <gtest/gtest.h>

#include <cmath>

#include "support/overhung.hpp"
#include "whirl/film/contract/film.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/spectral/eigenvalues.hpp"

using namespace whirl;
using Eigen::Index;
using Eigen::VectorXd;
using test::equilibrium;
using test::overhung;
using test::pads;
using test::support;

namespace {

constexpr double speed = 300;

}  // namespace

// A film in the middle of a shaft that is the same on both sides does not tilt, and answers as one that cannot.
TEST(Tilt, VanishesBySymmetry) {
  const auto solve_with = [](bool tilt) {
    system::Train t = overhung(false);
    t.rotor.discs.resize(1);
    t.rotor.discs[0].node = 4;
    using enum film::Geometry::Bore;
    t.supports = {support("left", 1, partial_arc, film::Linear{.stiffness = {1e7, 0, 0, 1e7}}),
                  support("middle", 4, partial_arc, pads(tilt)),
                  support("right", 7, partial_arc, film::Linear{.stiffness = {1e7, 0, 0, 1e7}})};
    system::RotorSystem s(MPI_COMM_WORLD, t, speed);
    const std::vector<double> x = s.gather(equilibrium(s).get());
    const auto film = s.film_responses(x.data(), film::Need::tangents)[1];
    const auto at = s.journals(x.data())[1];
    EXPECT_LT(std::hypot(at.tilt[0], at.tilt[1]), 1e-14);
    return std::pair{at.position, film};
  };
  const auto [on, film_on] = solve_with(true);
  const auto [off, film_off] = solve_with(false);
  for (std::size_t d = 0; d < 2; ++d) {
    EXPECT_NEAR(on[d], off[d], 1e-10 * 1e-4);
    EXPECT_NEAR(film_on.force[d], film_off.force[d], 1e-10 * film_off.force[1]);
    EXPECT_NEAR(film_on.force[2 + d], 0, 1e-10 * film_off.force[1] * 0.08);
    for (std::size_t e = 0; e < 2; ++e) {
      EXPECT_NEAR(film_on.d_position[d][e], film_off.d_position[d][e], 1e-10 * std::abs(film_off.d_position[1][1]));
      EXPECT_NEAR(film_on.d_velocity[d][e], film_off.d_velocity[d][e], 1e-10 * std::abs(film_off.d_velocity[1][1]));
    }
  }
  // Against a slope it stands.
  EXPECT_GT(-film_on.d_position[3][3], 0);
  EXPECT_GT(-film_on.d_velocity[3][3], 0);
}

// Cycles by the elimination that knows of four ports, and by the general one.
TEST(Tilt, CyclesByEveryWay) {
  for (const bool states : {false, true}) {
    system::Train t = states ? test::overhung_with_states() : overhung(true, {12, 6});
    if (states) {
      t.rotor.reduction.type = rotor::Reduction::Type::guyan;
      t.rotor.reduction.masters = {1, 5, 7};
      t.rotor.reduction.slopes = {1, 5};
    }
    const auto cycle = [&](bool structured) {
      system::RotorSystem s(PETSC_COMM_SELF, t, speed);
      const core::Vector x = equilibrium(s);
      solve::CycleOptions o;
      o.degree = 3;
      o.points = solve::Points::radau;
      o.use_structure = structured;
      constexpr int intervals = 8;
      solve::CycleProblem p(MPI_COMM_WORLD, s, o, solve::uniform_mesh(intervals));
      solve::Cycle guess{p.mesh(), {}, 2 * M_PI / speed, speed};
      const auto whole = s.gather(x.get());
      guess.x = Eigen::Map<const VectorXd>(whole.data(), s.size()).replicate(1, intervals * o.degree);
      core::Vector u = p.scatter(guess), row = core::duplicate(u.get());
      solve::parameter_row(p, row.get());
      solve::NewtonOptions newton;
      newton.max_iterations = 60;
      const auto r = solve::newton(p, u.get(), row.get(), speed / o.parameter_scale, newton);
      EXPECT_TRUE(r.converged) << r.reason << " " << r.residual;
      p.linearise(u.get(), row.get());
      return std::pair{p.gather(u.get()).x, std::abs(spectral::eigenvalues(p.monodromy())[0])};
    };
    const auto [a, first] = cycle(true);
    const auto [b, second] = cycle(false);
    const Index machine =
        a.rows() -
        (states ? static_cast<Index>(
                      film::make_film(t.supports[1].geometry, t.supports[1].film, t.supports[1].lubricant)->states())
                : 0);
    EXPECT_LE((a - b).topRows(machine).cwiseAbs().maxCoeff(), 1e-8 * a.topRows(machine).cwiseAbs().maxCoeff());
    EXPECT_NEAR(first, second, 1e-7);
    // The journal moves, and tilts as it does.
    EXPECT_GT((a.row(2).array() - a.row(2).mean()).abs().maxCoeff(), 1e-7);
  }
}
