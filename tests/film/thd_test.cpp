// The film with heat against the film of one temperature, exact temperatures, and its balances.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "film/heat/one_layer_pad.hpp"
#include "film/heat/thd_pad.hpp"
#include "film/thd_cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

constexpr double kTurn = 377.0;

Thd cool(std::array<int, 2> cells, int layers, Turbulence turbulence, bool tilt) {
  Thd o;
  o.cells = cells;
  o.layers = layers;
  o.turbulence = turbulence;
  o.tilt = tilt;
  return o;
}

// Of constant viscosity it is the film of one temperature, to rounding.
TEST(ThdFilm, IsTheFilmOfOneTemperatureWhereTheViscosityIsConstant) {
  for (const Turbulence turbulence : {Turbulence::laminar, Turbulence::constantinescu})
    for (const bool tilt : {false, true})
      for (const int layers : {1, 3})
        for (const auto cavitation : {Thd::Cavitation::half_sommerfeld, Thd::Cavitation::none}) {
          const std::array<int, 2> cells = tilt ? std::array{14, 7} : std::array{21, 8};
          Thd heat = cool(cells, layers, turbulence, tilt);
          heat.cavitation = cavitation;
          Reynolds plain;
          plain.cells = cells;
          plain.turbulence = turbulence;
          plain.tilt = tilt;
          plain.cavitation =
              cavitation == Thd::Cavitation::none ? Reynolds::Cavitation::none : Reynolds::Cavitation::half_sommerfeld;
          const auto a = make_film(lemon(), heat, oil()), b = make_film(lemon(), plain, oil());
          const JournalMotion m = motion(lemon(), {0.3, -0.5, 0.2, 0.1}, {0.03, -0.05, 0.02, 0.01}, kTurn);
          const Response x = evaluate(*a, m), y = evaluate(*b, m);
          double load = 0, stiffness = 0, damping = 0, speed = 0;
          for (std::size_t i = 0; i < 4; ++i) {
            load = std::max(load, std::abs(y.force[i]));
            speed = std::max(speed, std::abs(y.d_speed[i]));
            for (std::size_t j = 0; j < 4; ++j) {
              stiffness = std::max(stiffness, std::abs(y.d_position[i][j]));
              damping = std::max(damping, std::abs(y.d_velocity[i][j]));
            }
          }
          ASSERT_GT(load, 0);
          for (std::size_t i = 0; i < 4; ++i) {
            EXPECT_NEAR(x.force[i], y.force[i], 1e-10 * load);
            EXPECT_NEAR(x.d_speed[i], y.d_speed[i], 1e-9 * speed);
            for (std::size_t j = 0; j < 4; ++j) {
              EXPECT_NEAR(x.d_position[i][j], y.d_position[i][j], 1e-9 * stiffness);
              EXPECT_NEAR(x.d_velocity[i][j], y.d_velocity[i][j], 1e-9 * damping);
            }
          }
          const FilmReport r = a->summary(m, {}), s = b->summary(m, {});
          EXPECT_NEAR(r.max_pressure, s.max_pressure, 1e-9 * s.max_pressure);
          EXPECT_EQ(r.min_thickness, s.min_thickness);
        }
}

// The temperatures of a relaxed film.
struct Settled {
  std::unique_ptr<Film> film;
  std::vector<double> states;
};
Settled settle(const Geometry& geometry, Thd o, const Lubricant& lubricant, const JournalMotion& m) {
  o.states = States::dynamic;
  Settled out{make_film(geometry, o, lubricant), {}};
  out.states.resize(out.film->states());
  out.film->unloaded(m, out.states);
  relax(*out.film, m, out.states);
  return out;
}

// Array by array as node by node, in flow both ways: residuals, force and all derivatives, to rounding.
TEST(ThdFilm, OneLayerInArraysIsThatOfNodes) {
  for (const Turbulence turbulence : {Turbulence::laminar, Turbulence::constantinescu})
    for (const bool tilt : {false, true})
      for (const double speed : {kTurn, -kTurn, 0.0}) {
        Thd o = heated({9, tilt ? 5 : 7}, 1);
        o.turbulence = turbulence;
        o.tilt = tilt;
        const Pad pad = make_pads(lemon()).front();
        OneLayerPad arrays(pad, o, oil());
        ThdPad<1, 1> nodes(pad, o, oil());
        const auto n = static_cast<std::size_t>(nodes.states());
        std::vector<double> states(n), rates(n);
        for (std::size_t k = 0; k < n; ++k) {
          const double wave = std::sin(7.3 * static_cast<double>(k));
          states[k] = k % 2 == 0 ? 3e5 * wave : 330.0 + 12.0 * wave;
          rates[k] = k % 2 == 0 ? 0.0 : 5.0 * std::cos(3.1 * static_cast<double>(k));
        }
        const JournalMotion m = motion(lemon(), {0.3, -0.5, 0.2, 0.1}, {0.03, -0.05, 0.02, 0.01}, speed);
        Places by_states, by_rates;
        nodes.add_places(0, by_states, by_rates);
        const auto evaluated = [&](auto& film) {
          StateResponse r;
          r.residual.resize(n);
          r.d_states.resize(by_states.size());
          r.d_rates.resize(by_rates.size());
          r.d_speed.resize(n);
          r.resize(true, tilt ? 4 : 2, static_cast<Eigen::Index>(n));
          r.inputs.setZero();
          r.forces.setZero();
          std::size_t at = 0, at_rates = 0;
          film.evaluate(m, states, rates, Need::tangents, 0, at, at_rates, r);
          EXPECT_EQ(at, by_states.size());
          EXPECT_EQ(at_rates, by_rates.size());
          return r;
        };
        const StateResponse a = evaluated(arrays), b = evaluated(nodes);
        // Rows of one kind have one unit, blocks of four entries four.
        const auto same = [](const std::vector<double>& x, const std::vector<double>& y, std::size_t kinds) {
          ASSERT_EQ(x.size(), y.size());
          std::vector<double> largest(kinds, 0.0);
          for (std::size_t k = 0; k < y.size(); ++k) largest[k % kinds] = std::max(largest[k % kinds], std::abs(y[k]));
          for (std::size_t k = 0; k < y.size(); ++k) ASSERT_NEAR(x[k], y[k], 1e-12 * largest[k % kinds]) << k;
        };
        same(a.residual, b.residual, 2);
        same(a.d_states, b.d_states, 4);
        same(a.d_rates, b.d_rates, 1);
        same(a.d_speed, b.d_speed, 2);
        const auto rows_of = [](const ThinRows& of, Eigen::Index row) {
          return std::vector<double>(of.row(row).begin(), of.row(row).end());
        };
        for (Eigen::Index row = 0; row < a.inputs.rows(); ++row)
          same(rows_of(a.inputs, row), rows_of(b.inputs, row), 2);
        for (Eigen::Index row = 0; row < a.forces.rows(); ++row)
          same(rows_of(a.forces, row), rows_of(b.forces, row), 2);
        for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(a.journal.force[c], b.journal.force[c]);
      }
}

// Between adiabatic walls a concentric film warms along its way by what its shear dissipates: with mu = mu_0 exp(-b (T
// - T_0)) and s = 2 mu_0 U x/(rho c h^2), T - T_0 = ln(1 + b s)/b. Vogel's law with a far pole is this one.
TEST(ThdFilm, WarmsAlongAnAdiabaticFilm) {
  const Geometry g = arc();
  const Lubricant oil{0.02, 850.0};
  const double b = 0.03, far = 1e5, c = 2000;
  std::array<double, 3> error{};
  for (std::size_t level = 0; level < error.size(); ++level) {
    Thd o = cool({20 << level, 4}, 1, Turbulence::laminar, false);
    o.viscosity =
        thermal::ViscosityOptions{thermal::Vogel{oil.viscosity, 313.15, b * (313.15 + far) * (313.15 + far), -far}};
    JournalMotion m;
    m.speed = 900;
    const Settled s = settle(g, o, oil, m);
    for (const NodalField& f : s.film->fields(m, s.states)) {
      if (f.name != "temperature") continue;
      const double x = g.radius * g.arc, u = m.speed * g.radius;
      const double exact =
          std::log(1 + b * 2 * oil.viscosity * u * x / (oil.density * c * g.clearance * g.clearance)) / b;
      EXPECT_GT(exact, 5.0);
      error[level] = std::abs(f.values[f.values.size() - 3] - o.feed - exact);
    }
  }
  EXPECT_GE(std::log2(error[1] / error[2]), 0.9);
  EXPECT_LT(error[2], 0.3);
}

// Far behind the edge of a film between walls of one temperature: T = T_w + mu U^2/(2 lambda) zeta (1 - zeta).
TEST(ThdFilm, IsAParabolaBetweenIsothermalWalls) {
  const Geometry g = arc();
  const double conductivity = 20;  // no oil: soon developed
  JournalMotion m;
  m.speed = kTurn;
  const double u = m.speed * g.radius, mean = oil().viscosity * u * u / (12 * conductivity);
  std::array<double, 3> error{};
  const auto risen = [&](int layers) {
    Thd o = cool({20, 4}, layers, Turbulence::laminar, false);
    o.conductivity = conductivity;
    o.feed = 313.15;
    o.bush = o.journal = {HeatedWall::Type::isothermal, 313.15};
    const Settled s = settle(g, o, oil(), m);
    return s.film->summary(m, s.states).mean_temperature;
  };
  const auto at_end = [&](int layers) {
    Thd o = cool({20, 4}, layers, Turbulence::laminar, false);
    o.conductivity = conductivity;
    o.bush = o.journal = {HeatedWall::Type::isothermal, o.feed};
    const Settled s = settle(g, o, oil(), m);
    for (const NodalField& f : s.film->fields(m, s.states))
      if (f.name == "temperature") return f.values[f.values.size() - 3] - o.feed;
    return 0.0;
  };
  EXPECT_GT(risen(1), 313.15);
  EXPECT_NEAR(at_end(1), mean, 1e-5 * mean);
  for (std::size_t level = 0; level < error.size(); ++level) error[level] = std::abs(at_end(4 << level) - mean);
  EXPECT_GE(std::log2(error[0] / error[1]), 1.9);
  EXPECT_GE(std::log2(error[1] / error[2]), 1.9);
}

// What the shaft loses is what the film dissipates, and what the film dissipates leaves it.
TEST(ThdFilm, BalancesItsHeat) {
  for (const HeatedCase& c : heated_films()) {
    const JournalMotion m = motion(c.geometry, c.position, {}, kTurn);
    const Settled s = settle(c.geometry, c.options, oil(), m);
    HeatBalance all;
    double power = 0;
    std::size_t first = 0;
    for (const Pad& pad : make_pads(c.geometry)) {
      ThdPad<Eigen::Dynamic, Eigen::Dynamic> alone(pad, c.options, oil());
      const auto n = static_cast<std::size_t>(alone.states());
      StateResponse r;
      r.residual.resize(n);
      r.journal.min_thickness = 1;
      std::size_t at = 0, at_rates = 0;
      const std::vector<double> rates(n, 0.0);
      alone.evaluate(m, std::span(s.states).subspan(first, n), rates, Need::force, 0, at, at_rates, r);
      first += n;
      const HeatBalance h = alone.heat();
      all.dissipation += h.dissipation;
      all.carried += h.carried;
      all.bush += h.bush;
      all.journal += h.journal;
      EXPECT_EQ(h.stored, 0);
      power += alone.friction() * m.speed;
    }
    EXPECT_GT(all.dissipation, 0);
    EXPECT_GT(std::abs(all.bush), 1e-3 * all.dissipation);
    EXPECT_NEAR(all.dissipation, power, 1e-8 * power) << c.name;
    EXPECT_NEAR(all.carried + all.bush + all.journal, all.dissipation, 1e-8 * power) << c.name;
    const FilmReport report = s.film->summary(m, s.states);
    EXPECT_NEAR(report.power_loss, power, 1e-12 * power);
    EXPECT_NEAR(report.imbalance, 0, 1e-9 * report.inlet_flow);
    EXPECT_GT(report.max_temperature, report.mean_temperature);
  }
}

// Without sources a constant temperature stays: no viscosity to speak of, walls and feed alike.
TEST(ThdFilm, KeepsAConstantTemperature) {
  Thd o = cool({20, 8}, 5, Turbulence::laminar, false);
  o.heat_capacity = 1e14;
  o.bush = {HeatedWall::Type::isothermal, o.feed};
  const JournalMotion m = motion(lemon(), {0.5, -0.5, 0, 0}, {}, kTurn);
  const Settled s = settle(lemon(), o, oil(), m);
  const FilmReport r = s.film->summary(m, s.states);
  EXPECT_NEAR(r.max_temperature, o.feed, 1e-6);
  EXPECT_NEAR(r.mean_temperature, o.feed, 1e-6);
}

TEST(ThdFilm, RefusesWhatItIsNot) {
  EXPECT_THROW((void)make_film(cylinder(), Thd{}, oil()), core::InputError);
  Thd o;
  o.layers = 0;
  EXPECT_THROW((void)make_film(arc(), o, oil()), core::InputError);
}

}  // namespace
}  // namespace whirl::film::testing
