// Exact limits of films of gas, with the order at which the mesh or the parameter reaches them.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "film/gas_cases.hpp"
#include "whirl/thermal/orifice.hpp"

namespace whirl::film::testing {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

Geometry bore(double length_to_diameter) {
  Geometry g = spindle();
  g.length = length_to_diameter * 2.0 * g.radius;
  return g;
}
double speed_at(const Geometry& g, double bearing_number) {
  const double slender = g.radius / g.clearance;
  return bearing_number * Gas{}.ambient / (6.0 * air().viscosity * slender * slender);
}
// Load over p_a L D, against the eccentricity and across it.
Complex load(const Geometry& g, const Gas& o, double eccentricity, double bearing_number) {
  const SolvedGas s = solved(g, o, {eccentricity, 0.0}, speed_at(g, bearing_number));
  return Complex(-s.journal.force[0], s.journal.force[1]) / (o.ambient * g.length * 2.0 * g.radius);
}

// Linearised in the eccentricity: (pi/2) i L/(1 + i L) (1 - tanh(k l)/(k l)), k^2 = 1 + i L, l = length/diameter.
TEST(GasExact, SmallEccentricities) {
  constexpr double small = 1e-4;
  for (const double ratio : {0.5, 1.0, 2.0})
    for (const double number : {0.1, 1.0, 10.0}) {
      const Complex i(0.0, 1.0), k = std::sqrt(1.0 + i * number);
      const Complex exact = 0.5 * pi * i * number / (1.0 + i * number) * (1.0 - std::tanh(k * ratio) / (k * ratio));
      std::array<double, 3> error{};
      for (std::size_t n = 0; n < 3; ++n) {
        const Geometry g = bore(ratio);
        error[n] = std::abs(load(g, self_acting({16 << n, 8 << n}), small, number) / small - exact) / std::abs(exact);
      }
      EXPECT_LT(error[2], 6e-3) << ratio << " " << number;
      for (std::size_t n = 0; n < 2; ++n)
        EXPECT_NEAR(std::log2(error[n] / error[n + 1]), 2.0, 0.15) << ratio << " " << number;
    }
}

// p h becomes constant with the speed, but for layers at the ends whose width falls with its root:
// W/(p_a L D) = (pi/eps) (1/sqrt(1 - eps^2) - 1) sqrt(1 + 1.5 eps^2) along the eccentricity.
TEST(GasExact, HighSpeeds) {
  const Geometry g = bore(4.0);
  for (const double eps : {0.2, 0.6}) {
    const double exact = pi / eps * (1.0 / std::sqrt(1.0 - eps * eps) - 1.0) * std::sqrt(1.0 + 1.5 * eps * eps);
    // Over speeds four times as high each: what is left after the root is taken out falls with the speed.
    std::array<Complex, 3> at;
    for (std::size_t n = 0; n < 3; ++n) at[n] = load(g, self_acting({48, 192}), eps, 25.0 * std::pow(4.0, n));
    const double before = std::abs(2.0 * at[1] - at[0] - exact), after = std::abs(2.0 * at[2] - at[1] - exact);
    EXPECT_NEAR(std::log(before / after) / std::log(4.0), 1.0, 0.3) << eps;
    EXPECT_LT(after, 1e-2 * exact);
    EXPECT_GT(std::abs(at[2] - exact), after);  // the layers themselves
  }
}

// The incompressible film without cavitation is the limit of low speeds, reached in proportion to the speed.
TEST(GasExact, LowSpeeds) {
  const Geometry g = bore(1.0);
  Reynolds oil_like;
  oil_like.cavitation = Reynolds::Cavitation::none;
  oil_like.cells = {64, 32};
  const auto film = make_film(g, oil_like, air());
  std::array<double, 2> distance{};
  for (std::size_t n = 0; n < 2; ++n) {
    const double number = n == 0 ? 2e-2 : 1e-2;
    const SolvedGas s = solved(g, self_acting({64, 32}), {0.5, 0.0}, speed_at(g, number));
    Response r;
    film->evaluate(s.motion, Need::force, r);
    const double all = std::hypot(r.force[0], r.force[1]);
    distance[n] = std::abs(s.journal.force[0] - r.force[0]) / all;
    EXPECT_NEAR(s.journal.force[1], r.force[1], 2e-3 * all);
    EXPECT_LT(std::abs(r.force[0]), 1e-6 * all);
  }
  EXPECT_NEAR(distance[0] / distance[1], 2.0, 0.02);
}

// A row around a bearing at rest, journal in the middle: p_o^2 = p_a^2 + K m (n pi L/(2 pi R 2) + ln(s/(pi d))), K = 12
// mu r T/(pi c^3), s = 2 pi R/n; images beyond the ends add 1e-7 of it.
TEST(GasExact, OrificesAtRest) {
  const Geometry g = spindle();
  const Gas o = aerostatic(1, 5e5, {16, 8});
  const OrificeRow& row = o.orifices.front();
  const double K = 12.0 * air().viscosity * o.gas_constant * o.temperature / (pi * std::pow(g.clearance, 3));
  const double around = 2.0 * pi * g.radius;
  const double resists =
      K * (row.count * 2.0 * pi / around * g.length / 4.0 + std::log(around / (row.count * pi * row.diameter)));
  const double area = 0.25 * pi * row.diameter * row.diameter * thermal::discharge(g.clearance, row.diameter);
  double low = o.ambient, high = row.supply, mass = 0.0;
  for (int k = 0; k < 60; ++k) {
    const double p = 0.5 * (low + high);
    mass = area * thermal::nozzle({o.gas_constant, o.heat_ratio}, row.supply, o.temperature, p).value;
    (p * p < o.ambient * o.ambient + resists * mass ? low : high) = p;
  }
  std::array<double, 3> error{};
  for (std::size_t n = 0; n < 3; ++n) {
    const SolvedGas s = solved(g, aerostatic(1, 5e5, {32 << n, 12 << n}), {0.0, 0.0}, 0.0);
    error[n] = std::abs(s.states.back() - low) / low;
    EXPECT_NEAR(s.report.mass_flow, row.count * mass, 2.0 * error[n] * row.count * mass);
  }
  EXPECT_LT(error[2], 1e-4);
  for (std::size_t n = 0; n < 2; ++n) EXPECT_GT(std::log2(error[n] / error[n + 1]), 1.8);
}

}  // namespace
}  // namespace whirl::film::testing
