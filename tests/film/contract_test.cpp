// Every film: Taylor tests of all derivatives, errors, and what callers rely on.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "film/cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

struct Case {
  std::string name;
  Geometry geometry;
  Options options;
  std::array<double, 4> position, velocity;
};

Reynolds options(Reynolds::Cavitation cavitation, Turbulence turbulence, bool tilt, std::array<int, 2> cells) {
  Reynolds o;
  o.cavitation = cavitation;
  o.turbulence = turbulence;
  o.tilt = tilt;
  o.cells = cells;
  return o;
}

// On a liner whose deflection is that of the moment.
template <class Kind>
Options soft(Kind o, std::array<int, 2> cells) {
  o.states = States::condensed;
  o.compliance = 0.1;
  o.reference_speed = 300.0;
  o.cells = cells;
  o.differences = Compliant::Differences::central;
  return o;
}

std::vector<Case> cases() {
  using C = Reynolds::Cavitation;
  using T = Turbulence;
  const std::array<double, 4> loaded = {0.9, -0.4, 0.2, -0.15}, moving = {0.05, -0.08, 0.03, 0.02};
  const std::array<double, 4> shallow = {0.2, -0.6, 0.1, 0.1};
  Linear linear;
  linear.stiffness = {4e8, -1e8, -1e9, 1.6e9};
  linear.damping = {1e6, -1.5e6, -2e6, 6e6};
  Geometry offset = lemon();
  offset.offset = 0.5 * offset.clearance;
  Reynolds grooved = options(C::half_sommerfeld, T::constantinescu, false, {48, 12});
  grooved.grooves = {{90.0 * kDegree, 20.0 * kDegree}, {-30.0 * kDegree, 0.0}};
  Reynolds grooved_reynolds = grooved;
  grooved_reynolds.cavitation = C::reynolds;
  Reynolds starved = options(C::mass_conserving, T::constantinescu, false, {60, 16});
  starved.edge_fill = 0.7;
  Reynolds fed = options(C::mass_conserving, T::laminar, false, {48, 12});
  fed.grooves = {{90.0 * kDegree, 20.0 * kDegree, 2e5}, {-30.0 * kDegree, 0.0, 0.0}};
  Reynolds holed = fed;
  holed.grooves.resize(1);
  holed.holes = {{230.0 * kDegree, 0.01, 0.02, 3e5}, {-40.0 * kDegree, -0.015, 0.018, 1e5}};
  Reynolds holed_tilted = holed;
  holed_tilted.tilt = true;
  Reynolds hole = options(C::half_sommerfeld, T::constantinescu, false, {48, 12});
  hole.holes = {{250.0 * kDegree, 0.03, 0.1, 0.0}};
  Reynolds hole_reynolds = hole;
  hole_reynolds.cavitation = C::reynolds;
  const auto with_inlet = [](Reynolds o, Inlet inlet) {
    o.inlet = inlet;
    return o;
  };
  const Inlet widest{Inlet::Type::maximum_gap, 0.0}, line{Inlet::Type::line, 40.0 * kDegree};
  return {
      {"lemon_half_sommerfeld", lemon(), options(C::half_sommerfeld, T::constantinescu, false, {60, 16}), loaded,
       moving},
      {"lemon_odd_rows", lemon(), options(C::half_sommerfeld, T::constantinescu, false, {37, 19}), loaded, moving},
      {"lemon_many_modes", lemon(), options(C::half_sommerfeld, T::laminar, false, {40, 44}), loaded, moving},
      {"lemon_offset", offset, options(C::half_sommerfeld, T::constantinescu, false, {60, 16}), loaded, moving},
      {"lemon_uncavitated", lemon(), options(C::none, T::constantinescu, false, {30, 10}), loaded, moving},
      {"lemon_reynolds", lemon(), options(C::reynolds, T::constantinescu, false, {60, 16}), loaded, moving},
      {"lemon_reynolds_odd_rows", lemon(), options(C::reynolds, T::constantinescu, false, {31, 11}), loaded, moving},
      {"lemon_tilted", lemon(), options(C::half_sommerfeld, T::constantinescu, true, {60, 16}), loaded, moving},
      {"lemon_tilted_reynolds", lemon(), options(C::reynolds, T::constantinescu, true, {60, 16}), loaded, moving},
      {"lemon_tilted_uncavitated", lemon(), options(C::none, T::laminar, true, {23, 9}), loaded, moving},
      {"arc_half_sommerfeld", arc(), options(C::half_sommerfeld, T::constantinescu, false, {60, 16}), shallow, moving},
      {"arc_tilted", arc(), options(C::half_sommerfeld, T::constantinescu, true, {41, 13}), shallow, moving},
      {"closed_half_sommerfeld", cylinder(), options(C::half_sommerfeld, T::constantinescu, false, {60, 16}), shallow,
       moving},
      {"closed_odd_rows", cylinder(), options(C::half_sommerfeld, T::laminar, false, {37, 19}), shallow, moving},
      {"closed_reynolds", cylinder(), options(C::reynolds, T::constantinescu, false, {60, 16}), shallow, moving},
      {"closed_uncavitated", cylinder(), options(C::none, T::laminar, false, {30, 10}), shallow, moving},
      {"closed_tilted", cylinder(), options(C::half_sommerfeld, T::constantinescu, true, {41, 13}), shallow, moving},
      {"closed_grooved", cylinder(), grooved, shallow, moving},
      {"closed_grooved_reynolds", cylinder(), grooved_reynolds, shallow, moving},
      {"inlet_widest", cylinder(), with_inlet(options(C::half_sommerfeld, T::constantinescu, false, {60, 16}), widest),
       shallow, moving},
      {"inlet_widest_reynolds", cylinder(), with_inlet(options(C::reynolds, T::laminar, false, {60, 16}), widest),
       shallow, moving},
      {"inlet_widest_tilted", cylinder(), with_inlet(options(C::reynolds, T::constantinescu, true, {41, 13}), widest),
       shallow, moving},
      {"inlet_line", cylinder(), with_inlet(options(C::half_sommerfeld, T::laminar, false, {48, 12}), line), shallow,
       moving},
      {"inlet_line_reynolds", cylinder(), with_inlet(options(C::reynolds, T::constantinescu, false, {48, 12}), line),
       shallow, moving},
      {"lemon_conserving", lemon(), options(C::mass_conserving, T::constantinescu, false, {60, 16}), loaded, moving},
      {"lemon_tilted_conserving", lemon(), options(C::mass_conserving, T::laminar, true, {41, 13}), loaded, moving},
      {"arc_starved", arc(), starved, shallow, moving},
      {"closed_grooved_conserving", cylinder(), fed, shallow, moving},
      {"closed_holes_conserving", cylinder(), holed, shallow, moving},
      {"closed_holes_tilted_conserving", cylinder(), holed_tilted, shallow, moving},
      {"lemon_hole", lemon(), hole, loaded, moving},
      {"lemon_hole_reynolds", lemon(), hole_reynolds, loaded, moving},
      {"inlet_widest_conserving", cylinder(),
       with_inlet(options(C::mass_conserving, T::constantinescu, false, {60, 16}), widest), shallow, moving},
      {"linear", arc(), linear, shallow, moving},
      {"soft_short", cylinder(), soft(CompliantShort{}, {50, 4}), shallow, moving},
      {"soft_long", cylinder(), soft(CompliantLong{}, {50, 4}), shallow, moving},
      {"soft_finite", cylinder(), soft(CompliantFinite{}, {24, 8}), shallow, moving},
      {"short", cylinder(), Short{}, shallow, moving},
      {"long", cylinder(), Long{}, shallow, moving},
      {"long_inlet", cylinder(), LongInlet{}, shallow, moving},
      {"finite_approximate", cylinder(), FiniteApproximate{}, shallow, moving},
  };
}

class Contract : public ::testing::TestWithParam<Case> {};

// |F(s + e d) - F(s) - e dF d| must fall as e^2. Reynolds cavitation has kinks in its tangents: small steps, so that
// none lies between.
TEST_P(Contract, TaylorRemainderIsSecondOrder) {
  const Case& c = GetParam();
  const Reynolds* reynolds = find<Reynolds>(c.options);
  const bool kinked = reynolds != nullptr && (reynolds->cavitation == Reynolds::Cavitation::reynolds ||
                                              reynolds->cavitation == Reynolds::Cavitation::mass_conserving);
  auto model = make_film(c.geometry, c.options, oil());
  const JournalMotion base = motion(c.geometry, c.position, c.velocity, 377.0);
  const Response at = evaluate(*model, base);
  const std::size_t components = facts(c.options).tilts ? 4 : 2;
  const auto scale = [&](std::size_t j) {
    return j < 2 ? c.geometry.clearance : c.geometry.clearance / c.geometry.length;
  };
  for (std::size_t variable = 0; variable < 9; ++variable) {
    const std::size_t j = variable % 4;
    if (variable < 8 && j >= components) continue;
    std::array<double, 2> remainder{};
    double slope_size = 0.0;
    const double first = kinked ? 4e-5 : reynolds == nullptr || reynolds->grooves.empty() ? 4e-3 : 4e-4;
    for (std::size_t k = 0; k < 2; ++k) {
      const double e = k == 0 ? first : 0.5 * first;
      JournalMotion moved = base;
      double step = e * 377.0;
      if (variable < 4)
        moved.position[j] += step = e * scale(j);
      else if (variable < 8)
        moved.velocity[j] += step = e * scale(j) * 377.0;
      else
        moved.speed += step;
      const Response there = evaluate(*model, moved, Need::force);
      for (std::size_t i = 0; i < components; ++i) {
        const double slope = variable < 4 ? at.d_position[i][j] : variable < 8 ? at.d_velocity[i][j] : at.d_speed[i];
        const double size = i < 2 ? 1.0 : 1.0 / c.geometry.length;
        remainder[k] += std::abs(there.force[i] - at.force[i] - slope * step) * size;
        if (k == 1) slope_size += std::abs(slope * step) * size;
      }
    }
    const double load = std::abs(at.force[0]) + std::abs(at.force[1]);
    if (!facts(c.options).coefficients) {
      EXPECT_TRUE(slope_size > 0.0) << "variable " << variable;
    }
    if (remainder[1] < 1e-11 * load) continue;  // exactly linear up to rounding
    EXPECT_GE(std::log2(remainder[0] / remainder[1]), 1.85) << c.name << " variable " << variable;
    EXPECT_LT(remainder[1], 0.2 * slope_size) << c.name << " variable " << variable;
  }
}

TEST_P(Contract, ForceDoesNotDependOnNeedOrHistory) {
  const Case& c = GetParam();
  auto model = make_film(c.geometry, c.options, oil());
  auto fresh = make_film(c.geometry, c.options, oil());
  const JournalMotion here = motion(c.geometry, c.position, c.velocity, 377.0);
  const JournalMotion elsewhere = motion(c.geometry, {-0.3, 0.2, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}, 200.0);
  evaluate(*model, elsewhere);
  const Response a = evaluate(*model, here, Need::force), b = evaluate(*fresh, here, Need::tangents);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(a.force[i], b.force[i], 1e-10 * std::abs(b.force[1])) << i;
  EXPECT_EQ(a.d_position[0][0], 0.0);
}

TEST_P(Contract, ThicknessMustBePositive) {
  const Case& c = GetParam();
  auto model = make_film(c.geometry, c.options, oil());
  if (facts(c.options).coefficients) GTEST_SKIP();
  Response r;
  const JournalMotion beyond = motion(c.geometry, {0.0, -1.01, 0.0, 0.0}, {}, 377.0);
  if (!facts(c.options).gives_way) {
    EXPECT_THROW(model->evaluate(beyond, Need::force, r), core::DomainError);
    EXPECT_LT(model->least_thickness(beyond, {}), 0.0);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(model->evaluate(motion(c.geometry, {nan, 0.0, 0.0, 0.0}, {}, 377.0), Need::force, r), core::DomainError);
}

TEST_P(Contract, RestWithoutMotionGivesNoForce) {
  const Case& c = GetParam();
  auto model = make_film(c.geometry, c.options, oil());
  if (facts(c.options).coefficients) GTEST_SKIP();
  if (const Reynolds* reynolds = find<Reynolds>(c.options))
    for (const Groove& g : reynolds->grooves)
      if (g.pressure > 0.0) GTEST_SKIP();  // the oil fed to it carries
  const Response r = evaluate(*model, motion(c.geometry, c.position, {}, 0.0));
  // The pressure on a liner is a small difference of lengths.
  const double rounding = facts(c.options).gives_way ? 1e-6 : 0.0;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(r.force[i], 0.0, rounding);
}

// Whoever takes any film finds no rows where there are no states, whatever the response held before.
TEST_P(Contract, AFilmWithoutStatesAnswersWithoutRows) {
  const Case& c = GetParam();
  const JournalMotion m = motion(c.geometry, c.position, c.velocity, 377.0);
  CompliantShort other;
  other.compliance = 0.1;
  other.reference_speed = 300.0;
  const auto with = make_film(cylinder(), other, oil());
  std::vector<double> states(with->states());
  const JournalMotion gentle = motion(cylinder(), {0.2, -0.3, 0.0, 0.0}, {}, 377.0);
  with->unloaded(gentle, states);
  StateResponse r;
  with->evaluate(gentle, states, std::vector<double>(states.size()), Need::tangents, r);
  ASSERT_EQ(r.residual.size(), states.size());

  auto film = make_film(c.geometry, c.options, oil());
  EXPECT_EQ(film->states(), 0U);
  EXPECT_FALSE(facts(c.options).own_states);
  EXPECT_TRUE(film->state_fields().empty());
  EXPECT_EQ(film->whole().rows(), 0);
  EXPECT_EQ(film->ports().size(), facts(c.options).tilts ? 4U : 2U);
  film->evaluate(m, film->whole(), {}, {}, Need::tangents, r);
  for (const std::vector<double>* v : {&r.residual, &r.d_states, &r.d_rates, &r.d_speed}) EXPECT_TRUE(v->empty());
  for (const ThinRows* v : {&r.inputs, &r.forces, &r.force_rates}) EXPECT_EQ(v->size(), 0);
  const Response alone = evaluate(*make_film(c.geometry, c.options, oil()), m);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(r.journal.force[i], alone.force[i], 1e-12 * std::abs(alone.force[1]));

  relax(*film, m, r.residual);
  EXPECT_TRUE(r.residual.empty());
  for (const double omega : {50.0, 500.0}) {
    const Coefficients k = coefficients(*film, m, {}, omega);
    for (std::size_t i = 0; i < 4; ++i) {
      // A film that searches its pressure finds it again to its tolerance.
      EXPECT_NEAR(k.stiffness[i], -alone.d_position[i / 2][i % 2], 1e-8 * std::abs(alone.d_position[1][1]));
      EXPECT_NEAR(k.damping[i], -alone.d_velocity[i / 2][i % 2], 1e-8 * std::abs(alone.d_velocity[1][1]));
    }
  }
  Film* const same = film.get();
  EXPECT_EQ(condense(std::move(film)).get(), same) << "there is nothing to condense";
}

INSTANTIATE_TEST_SUITE_P(Films, Contract, ::testing::ValuesIn(cases()),
                         [](const auto& which) { return which.param.name; });

TEST(Film, ImpossibleOptionsAreInputErrors) {
  Geometry g = arc();
  g.preload = 1.0;
  EXPECT_THROW(make_film(g, {}, oil()), core::InputError);
  g = arc();
  g.offset = 1e-5;
  EXPECT_THROW(make_film(g, {}, oil()), core::InputError);
  Reynolds coarse;
  coarse.cells = {2, 16};
  EXPECT_THROW(make_film(arc(), coarse, oil()), core::InputError);
  Reynolds turbulent;
  turbulent.turbulence = Turbulence::constantinescu;
  EXPECT_THROW(make_film(arc(), turbulent, {0.0067, 0.0}), core::InputError);
  Reynolds inlet;
  inlet.inlet.type = Inlet::Type::maximum_gap;
  EXPECT_THROW(make_film(arc(), inlet, oil()), core::InputError);
  inlet.grooves = {{0.0, 0.0}};
  EXPECT_THROW(make_film(cylinder(), inlet, oil()), core::InputError);
}

}  // namespace
}  // namespace whirl::film::testing
