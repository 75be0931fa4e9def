// Stiffness and damping at many frequencies from one factorisation.
#include "whirl/film/coefficients.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "film/gas_cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

// K + i omega C of what the states do, beside a complex LU; frequencies in any order use one basis.
void agree_with_factors(SolvedGas at, double tolerance) {
  FrequencyCoefficients krylov(*at.film, at.motion, at.states);
  for (const double omega : {2000.0, 20.0, 6000.0, 500.0, 40000.0, 1e-3}) {
    const PortCoefficients k = krylov.at(omega);
    const Eigen::MatrixXcd exact = krylov.by_factors(omega);
    StateResponse r;
    const std::vector<double> still(at.states.size(), 0.0);
    at.film->evaluate(at.motion, at.states, still, Need::tangents, r);
    for (std::size_t i = 0; i < k.ports; ++i)
      for (std::size_t j = 0; j < k.ports; ++j) {
        const auto d = [](std::size_t p) { return static_cast<Eigen::Index>(p); };
        const std::complex<double> found(k.stiffness[i][j] + r.journal.d_position[i][j],
                                         omega * (k.damping[i][j] + r.journal.d_velocity[i][j]));
        const double size = std::sqrt(std::abs(exact(d(i), d(i)) * exact(d(j), d(j))));
        EXPECT_LT(std::abs(found - exact(d(i), d(j))), tolerance * size) << omega << ' ' << i << j;
      }
  }
}

TEST(FrequencyCoefficients, AreThoseOfAComplexFactorisation) {
  for (const int rows : {1, 2}) {
    Gas o = aerostatic(rows, 6e5, {24, 8});
    agree_with_factors(solved(spindle(), o, {0.3, -0.4}, 2000), 1e-8);
    o.tilt = true;
    agree_with_factors(solved(spindle(), o, {0.016, -0.228}, 2000), 1e-8);
  }
  agree_with_factors(solved(spindle(), self_acting({20, 6}), {0.5, -0.2}, 2000), 1e-8);
}

TEST(FrequencyCoefficients, RefuseAFrequencyOfZero) {
  const SolvedGas at = solved(spindle(), aerostatic(1, 6e5, {16, 4}), {0.1, 0}, 1000);
  FrequencyCoefficients c(*at.film, at.motion, at.states);
  EXPECT_THROW((void)c.at(0), core::InputError);
}

}  // namespace
}  // namespace whirl::film::testing
