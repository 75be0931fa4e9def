// Films of gas against computations of bearings A and B and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "film/gas_cases.hpp"
#include "film/steady.hpp"

namespace whirl::film::testing {
namespace {

using std::numbers::pi;

struct Solved {
  std::unique_ptr<Film> film;
  JournalMotion motion;
  std::vector<double> states;
  Response journal;
  FilmReport report;
  long factorisations;
};

Solved solved(const Geometry& geometry, const Gas& options, std::array<double, 2> at, double speed) {
  Solved out{make_film(geometry, options, air()), {}, {}, {}, {}, 0};
  out.motion.position = {at[0] * geometry.clearance, at[1] * geometry.clearance, 0.0, 0.0};
  out.motion.speed = speed;
  out.states.resize(out.film->states());
  out.film->unloaded(out.motion, out.states);
  const std::vector<double> rest(out.states.size(), 0.0);
  Steady steady(*out.film);
  steady.solve(out.motion, rest, Steady::Until::small_step, Need::force, out.states);
  out.journal = steady.here().journal;
  out.report = out.film->summary(out.motion, out.states);
  out.factorisations = steady.factorisations();
  return out;
}

double load(const Solved& s) {
  return std::hypot(s.journal.force[0], s.journal.force[1]);
}

TEST(Gas, Scratch) {
  for (const auto& [rows, ps, om] : {std::tuple(1, 5e5, 1000.0), std::tuple(2, 5e5, 1000.0), std::tuple(1, 6e5, 0.0),
                                     std::tuple(1, 6e5, 3141.5926), std::tuple(2, 6e5, 3141.5926)})
    for (const double eps : {0.1, 0.3, 0.6, 0.8, 0.9})
      for (const int n : {48, 96}) {
        const Solved s = solved(spindle(), aerostatic(rows, ps, {n, n / 3}), {eps, 0.0}, om);
        std::printf("%d %g %g %g %d: W %.6f F %.6f %.6f mdot %.6e torque %.6e imb %.3e factor %ld\n", rows, ps, om, eps, n,
                    load(s), s.journal.force[0], s.journal.force[1], s.report.mass_flow, s.report.drag_torque,
                    s.report.imbalance / s.report.side_flow, s.factorisations);
      }
}

}  // namespace
}  // namespace whirl::film::testing
