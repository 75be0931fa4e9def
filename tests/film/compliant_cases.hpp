#pragma once
// Films with own states that several tests share.

#include <vector>

#include "film/cases.hpp"
#include "support/film_of.hpp"
#include "whirl/film/state_model.hpp"

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

inline Motion still(double x, double y) {
  return motion(cylinder(), {x, y, 0.0, 0.0}, {}, kSpeed);
}

inline std::vector<double> relaxed(StateModel& film, const Motion& m) {
  std::vector<double> s(film.states());
  film.unloaded(m, s);
  relax(film, m, s);
  return s;
}

inline Response static_response(const Options& o, const Motion& m) {
  auto film = make_state_model(cylinder(), o, oil());
  const auto s = relaxed(*film, m);
  StateResponse r;
  film->evaluate(m, s, std::vector<double>(s.size(), 0.0), Need::tangents, r);
  return r.journal;
}

}  // namespace whirl::film::testing
