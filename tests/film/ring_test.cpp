// The V-cycle for films in lines: its rate of convergence does not depend on mesh, ratio of spacings or parity.
#include <gtest/gtest.h>

#include <cmath>

#include "film/cases.hpp"
#include "film/gas_cases.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film::testing {
namespace {

// Reduction of the residual of (sigma + alpha dg/ds) x = b per cycle x <- x + M (b - A x), over the last of eight or
// the one that brings it near rounding.
double rate(Film& film, const JournalMotion& m, const std::vector<double>& s, double alpha, double sigma) {
  const std::size_t n = film.states();
  const std::vector<double> zero(n, 0.0);
  StateResponse r;
  film.evaluate(m, s, zero, Need::tangents, r);
  const Share& all = film.whole();
  const auto cycle = film.inverse(MPI_COMM_SELF, all);
  cycle->set({r.d_states, r.d_rates}, alpha, sigma);
  std::vector<double> x(n, 0.0), residual(n), d(n);
  double size = 0.0, last = 0.0, first = 0.0;
  for (int k = 0; k < 8; ++k) {
    for (std::size_t i = 0; i < n; ++i) residual[i] = std::sin(1.7 * static_cast<double>(i * (i + 1)));
    const auto subtract = [&](const Places& places, const std::vector<double>& values, double factor) {
      for_entries(all, places, values, [&](int row, int column, double value) {
        residual[static_cast<std::size_t>(row)] -= factor * value * x[static_cast<std::size_t>(column)];
      });
    };
    subtract(all.d_states, r.d_states, alpha);
    subtract(all.d_rates, r.d_rates, sigma);
    last = size;
    size = 0.0;
    for (const double v : residual) size += v * v;
    if (k == 0) first = size;
    if (size < 1e-20 * first) break;
    cycle->apply(residual, d);
    for (std::size_t i = 0; i < n; ++i) x[i] += d[i];
  }
  return std::sqrt(size / last);
}

double rate(std::array<int, 2> cells, double dt, Compliant::Differences differences, bool contact = false) {
  const Geometry g{Geometry::Bore::cylindrical, 0.005, 0.01, 25e-6, 0.0, 0.0, 0.0};
  CompliantFinite o;
  o.cells = cells;
  o.compliance = 0.1;
  o.reference_speed = 160.0;
  o.differences = differences;
  if (contact) o.contact = Contact{0.2 * g.clearance, 1e7};
  auto film = make_film(g, o, {0.001, 1000.0});
  const JournalMotion m = motion(g, {0.5, -0.55, 0.0, 0.0}, {}, 800.0);
  std::vector<double> s(film->states());
  film->unloaded(m, s);
  for (std::size_t k = 0; k < s.size(); ++k) s[k] *= 1.0 + 0.1 * std::sin(0.01 * static_cast<double>(k));
  return rate(*film, m, s, dt, 1.0);
}

// Of a film of gas at rest, with its orifices; mass flows through them resolved by the mesh or not.
double rate_of_gas(int rows, std::array<int, 2> cells, double eccentricity, double sigma) {
  SolvedGas film = solved(spindle(), aerostatic(rows, 6e5, cells), {0.3 * eccentricity, -eccentricity}, 2000.0);
  return rate(*film.film, film.motion, film.states, 1.0, sigma);
}

TEST(StateInverse, RateDoesNotDependOnTheMesh) {
  const double dt = 0.005 / 160.0;
  using enum Compliant::Differences;
  for (const auto cells :
       {std::array{48, 10}, std::array{96, 20}, std::array{192, 40}, std::array{200, 6}, std::array{8, 60}})
    EXPECT_LT(rate(cells, dt, central), 0.1) << cells[0] << " x " << cells[1];
  for (const auto cells : {std::array{25, 10}, std::array{45, 40}, std::array{61, 9}, std::array{4, 2}})
    EXPECT_LT(rate(cells, dt, central), 0.25) << cells[0] << " x " << cells[1];
  EXPECT_LT(rate({96, 20}, 10.0 * dt, central), 0.2);
  EXPECT_LT(rate({96, 20}, dt, upwind), 0.3);
  for (const auto cells : {std::array{48, 10}, std::array{96, 20}, std::array{192, 40}, std::array{45, 40}})
    EXPECT_LT(rate(cells, dt, third_order), 0.15) << cells[0] << " x " << cells[1];
  EXPECT_LT(rate({96, 20}, 10.0 * dt, third_order), 0.15);
  // Asperities make the liner some fifteen times stiffer where the film is thinnest.
  for (const auto cells : {std::array{48, 10}, std::array{96, 20}, std::array{192, 40}})
    for (const auto differences : {central, third_order})
      EXPECT_LT(rate(cells, dt, differences, true), 0.15) << cells[0] << " x " << cells[1];
}

TEST(StateInverse, SolvesFilmsOfGasWithTheirOrifices) {
  for (const int rows : {0, 1, 2})
    for (const auto cells : {std::array{32, 8}, std::array{96, 32}, std::array{192, 64}, std::array{45, 20}})
      for (const double eccentricity : {0.0, 0.7})
        for (const double sigma : {0.0, 2000.0})
          EXPECT_LT(rate_of_gas(rows, cells, eccentricity, sigma), 0.25)
              << rows << " rows, " << cells[0] << " x " << cells[1] << ", " << eccentricity << ", " << sigma;
}

}  // namespace
}  // namespace whirl::film::testing
