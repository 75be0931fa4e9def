// Asperities that carry where a compliant film is thin.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "film/compliant_cases.hpp"
#include "film/wall/liner.hpp"

namespace whirl::film::testing {
namespace {

constexpr Contact kContact{4e-6, 3e8};  // 4 % of the clearance

LinerLaw law() {
  Compliant o;
  o.contact = kContact;
  return {cylinder(), o, 1e-3, 2.0};
}

// The fit of Hu et al. against the definition, F_5/2(x) = int_x^inf (s - x)^5/2 exp(-s^2/2)/sqrt(2 pi) ds.
TEST(Contact, PressureIsThatOfGaussianAsperities) {
  for (const double x : {0.5, 1.0, 2.0}) {
    double integral = 0.0;
    constexpr int n = 20000;
    for (int k = 1; k < n; ++k) {
      const double s = 10.0 * k / n;
      integral += 10.0 / n * std::pow(s, 2.5) * std::exp(-0.5 * (x + s) * (x + s)) / std::sqrt(2.0 * std::numbers::pi);
    }
    const double h = x * kContact.roughness / cylinder().clearance;
    EXPECT_NEAR(2.0 * law().contact(h).pressure, kContact.pressure * integral, 0.15 * kContact.pressure * integral)
        << x;
  }
}

TEST(Contact, PressureFallsSmoothlyToZero) {
  const double reach = 4.0 * kContact.roughness / cylinder().clearance;
  double last = 1e300;
  for (int k = 0; k <= 10; ++k) {
    const double h = 0.1 * k * reach, step = 1e-6 * reach;
    const LinerLaw::Value v = law().contact(h), ahead = law().contact(h + step), behind = law().contact(h - step);
    EXPECT_NEAR(v.slope, (ahead.pressure - behind.pressure) / (2.0 * step), 1e-6 * std::abs(law().contact(0.0).slope));
    EXPECT_TRUE(v.pressure < last || k == 0);
    last = v.pressure;
  }
  EXPECT_EQ(last, 0.0);
}

// At rest the film carries nothing: every place of the liner is pressed by the asperities above it alone, phi(u) =
// p_c(r + u), and the force points to the centre.
TEST(Contact, JournalAtRestIsCarriedByAsperities) {
  const Geometry g = cylinder();
  constexpr double e = 1.15, pressure_scale = 6.0;
  Elastic o = compliant(Kind::compliant_short, 0.1, 400, false);
  o.contact = kContact;
  const double scale = pressure_scale * oil().viscosity * std::pow(g.radius / g.clearance, 2);
  const LinerLaw liner(g, o, 0.1 / 300.0, scale);
  double exact = 0.0;
  constexpr int n = 20000;
  for (int k = 0; k < n; ++k) {
    const double theta = 2.0 * std::numbers::pi * k / n, r = 1.0 - e * std::cos(theta);
    double low = std::max(0.0, -r), high = 2.0;
    for (int i = 0; i < 60; ++i) {
      const double u = 0.5 * (low + high);
      (liner.elastic(u).pressure > liner.contact(r + u).pressure ? high : low) = u;
    }
    exact -=
        scale * liner.contact(r + low).pressure * std::cos(theta) * g.length * g.radius * 2.0 * std::numbers::pi / n;
  }
  EXPECT_LT(exact, 0.0);
  for (const auto kind : {Kind::compliant_short, Kind::compliant_finite})
    for (const auto quadrature : {Compliant::Quadrature::sub_cell, Compliant::Quadrature::simpson}) {
      o.kind = kind;
      o.quadrature = quadrature;
      auto film = make_film(g, o, oil());
      const JournalMotion m = motion(g, {e, 0.0, 0.0, 0.0}, {}, 0.0);
      const std::size_t line = kind == Kind::compliant_finite ? static_cast<std::size_t>(o.cells[1] - 1) : 1;
      std::vector<double> s(film->states());
      for (std::size_t k = 0; k < s.size(); ++k) {
        const double theta = 0.5 * std::numbers::pi + 2.0 * std::numbers::pi * static_cast<double>(k / line) / 400.0;
        s[k] = std::max(0.1, 1.0 - e * std::cos(theta)) * g.clearance;
      }
      relax(*film, m, s);
      StateResponse r;
      film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::force, r);
      EXPECT_NEAR(r.journal.force[0], exact, 2e-3 * std::abs(exact));
      EXPECT_NEAR(r.journal.force[1], 0.0, 1e-8 * std::abs(exact));
      EXPECT_GT(r.journal.min_thickness, 0.0);
    }
}

// A place without film: the layer under the asperities alone, and how it follows.
TEST(Contact, EdgeOfAFilm) {
  for (const bool rubber : {false, true}) {
    Compliant o;
    o.contact = kContact;
    if (rubber) o.rubber_thickness = 0.5 * cylinder().clearance;
    const LinerLaw liner(cylinder(), o, 1e-3, 2.0);
    for (const double rigid : {-0.3, -0.05, 0.02, 0.1, 0.159, 0.5}) {
      const LinerLaw::Edge edge = liner.edge(rigid), ahead = liner.edge(rigid + 1e-6),
                           behind = liner.edge(rigid - 1e-6);
      const double elastic = liner.elastic(edge.h - rigid).pressure;
      EXPECT_GT(edge.h, 0.0);
      EXPECT_NEAR(elastic, edge.contact.pressure, 1e-12 * liner.stiffness());
      EXPECT_EQ(edge.contact.pressure, liner.contact(edge.h).pressure);
      EXPECT_NEAR(edge.by_rigid, (ahead.h - behind.h) / 2e-6, 1e-6) << rigid;
    }
    EXPECT_EQ(liner.edge(0.5).h, 0.5);
  }
}

// L/D to 0 with asperities that carry a fixed part of the load: the short film with the same, with a difference of
// order (L/D)^2.
TEST(Contact, FiniteFilmTendsToTheShortOne) {
  const auto force = [](double length_to_diameter, Kind kind, bool contact) {
    Geometry g = cylinder();
    g.length = 2.0 * g.radius * length_to_diameter;
    Elastic o = compliant(kind, 0.1, 120, false);
    o.cells[1] = 24;
    if (contact) o.contact = Contact{0.25 * g.clearance, 2e9 * length_to_diameter * length_to_diameter};
    auto film = make_film(g, o, oil());
    const JournalMotion m = motion(g, {0.3, -0.3, 0.0, 0.0}, {}, kSpeed);
    StateResponse r;
    const auto s = relaxed(*film, m);
    film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::force, r);
    return std::array{r.journal.force[0], r.journal.force[1]};
  };
  std::array<double, 2> apart{};
  for (std::size_t k = 0; k < 2; ++k) {
    const double ratio = k == 0 ? 0.3 : 0.15;
    const auto exact = force(ratio, Kind::compliant_short, true), finite = force(ratio, Kind::compliant_finite, true),
               film_alone = force(ratio, Kind::compliant_short, false);
    const double size = std::hypot(exact[0], exact[1]);
    apart[k] = std::hypot(finite[0] - exact[0], finite[1] - exact[1]) / size;
    EXPECT_GT(std::hypot(film_alone[0] - exact[0], film_alone[1] - exact[1]), 0.2 * size);
  }
  EXPECT_LT(apart[1], 0.03);
  EXPECT_NEAR(std::log2(apart[0] / apart[1]), 2.0, 0.4);
}

}  // namespace
}  // namespace whirl::film::testing
