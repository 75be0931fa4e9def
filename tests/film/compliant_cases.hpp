#pragma once
// Films with own states that several tests share.

#include <cmath>
#include <string>
#include <vector>

#include "film/cases.hpp"
#include "support/film_of.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film::testing {

inline constexpr double kSpeed = 377.0;

inline Elastic compliant(Kind kind, double compliance, int cells, bool as_source) {
  Elastic o;
  o.kind = kind;
  o.compliance = compliance;
  o.reference_speed = 300.0;
  o.cells = {cells, kind == Kind::compliant_finite ? 8 : 4};
  if (as_source) {
    o.quadrature = Compliant::Quadrature::simpson;
    o.differences = Compliant::Differences::upwind;
  }
  return o;
}

inline JournalMotion still(double x, double y) {
  return motion(cylinder(), {x, y, 0.0, 0.0}, {}, kSpeed);
}

inline std::vector<double> relaxed(Film& film, const JournalMotion& m) {
  std::vector<double> s(film.states());
  film.unloaded(m, s);
  relax(film, m, s);
  return s;
}

inline Response static_response(const Options& o, const JournalMotion& m) {
  auto film = make_film(cylinder(), o, oil());
  const auto s = relaxed(*film, m);
  StateResponse r;
  film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::tangents, r);
  return r.journal;
}

/// Every kind with a liner, in its variants.
struct CompliantCase {
  std::string name;
  Elastic options;
};

inline std::vector<CompliantCase> compliant_films() {
  using enum Kind;
  std::vector<CompliantCase> all = {{"short", compliant(compliant_short, 0.1, 40, false)},
                                    {"short_as_source", compliant(compliant_short, 1.0, 50, true)},
                                    {"long", compliant(compliant_long, 0.1, 41, false)},
                                    {"long_as_source", compliant(compliant_long, 1.0, 50, true)},
                                    {"finite", compliant(compliant_finite, 0.1, 20, false)},
                                    {"finite_as_source", compliant(compliant_finite, 1.0, 22, true)}};
  const std::size_t plain = all.size();
  for (std::size_t k = 0; k < plain; k += 2) {
    CompliantCase c = all[k];
    const std::string name = c.name;
    c.options.differences = Compliant::Differences::third_order;
    c.name = name + "_third_order";
    all.push_back(c);
    c.options.liner_damping = 0.4 / kSpeed;
    c.options.rubber_thickness = 2.0 * cylinder().clearance;
    c.name = name + "_damped_rubber";
    all.push_back(c);
    c.options.rubber_thickness.reset();
    c.options.grooves = {{100.0 * kDegree, 0.0}, {-20.0 * kDegree, 30.0 * kDegree}};
    c.name = name + "_damped_grooved";
    all.push_back(c);
    c.options.contact = Contact{0.24 * cylinder().clearance, 1e10};
    c.name = name + "_damped_grooved_contact";
    all.push_back(c);
    c = all[k];
    c.options.contact = Contact{0.24 * cylinder().clearance, 1e10};
    c.options.rubber_thickness = 2.0 * cylinder().clearance;
    c.name = name + "_rubber_contact";
    all.push_back(c);
  }
  return all;
}

inline const JournalMotion kMoving = motion(cylinder(), {0.2, -0.4, 0.0, 0.0}, {0.05, -0.08, 0.0, 0.0}, kSpeed);

/// A state off equilibrium, smooth and with rates; thin enough for asperities, which are left out of what gives it.
struct CompliantPoint {
  JournalMotion motion;
  std::vector<double> states, rates;
};

inline CompliantPoint point(Elastic options) {
  options.contact.reset();
  const auto made = make_film(cylinder(), options, oil());
  Film& film = *made;
  CompliantPoint p{kMoving, relaxed(film, still(0.2, -0.4)), {}};
  for (std::size_t k = 0; k < p.states.size(); ++k) {
    const double c = scale_of(film), angle = 0.3 * static_cast<double>(k);
    p.states[k] += 0.02 * c * std::sin(angle);
    p.rates.push_back(0.1 * c * kSpeed * std::cos(angle));
  }
  return p;
}

}  // namespace whirl::film::testing
