// Stiffness and damping at many frequencies from one factorisation.
#include "whirl/film/use/coefficients.hpp"

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

// What forgets nothing: g = s' - v, force = -k s. dg/ds is zero, and the film a spring at every frequency.
class Integrator final : public Film {
public:
  static constexpr double stiffness = 3e6;
  using Film::evaluate;
  void evaluate(const JournalMotion& motion, const Share&, std::span<const double> states,
                std::span<const double> rates, Need, StateResponse& r) override {
    r.journal = {};
    r.residual.assign(2, 0);
    r.d_states.assign(2, 0);
    r.d_rates.assign(2, 1);
    r.d_speed.assign(2, 0);
    r.resize(true, 2, 2);
    r.inputs.setZero();
    r.forces = -stiffness * Eigen::Matrix2d::Identity();
    for (std::size_t i = 0; i < 2; ++i) {
      r.residual[i] = rates[i] - motion.velocity[i];
      r.by_velocity(i)[i] = -1;
      r.journal.force[i] = -stiffness * states[i];
    }
  }
  FilmReport summary(const JournalMotion&, std::span<const double>) override { return {}; }
  std::vector<NodalField> fields(const JournalMotion&, std::span<const double>) override { return {}; }
  [[nodiscard]] double least_thickness(const JournalMotion&, std::span<const double>) override { return 1; }
  [[nodiscard]] std::size_t states() const override { return 2; }
  [[nodiscard]] Share share(int begin, int end) const override {
    Share out{begin, end, {0, 1}, {}, {}};
    out.d_states.add({0, 0, 2});
    out.d_rates.add({0, 0, 2});
    return out;
  }
};

TEST(FrequencyCoefficients, OfAFilmThatIsSingularAtRest) {
  Integrator film;
  const std::vector<double> states(2, 0);
  FrequencyCoefficients c(film, {}, states);
  for (const double omega : {10.0, 1000.0}) {
    const PortCoefficients k = c.at(omega);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) {
        EXPECT_NEAR(k.stiffness[i][j], i == j ? Integrator::stiffness : 0, 1e-9 * Integrator::stiffness);
        EXPECT_NEAR(omega * k.damping[i][j], 0, 1e-9 * Integrator::stiffness);
      }
  }
}

TEST(FrequencyCoefficients, RefuseAFrequencyOfZero) {
  const SolvedGas at = solved(spindle(), aerostatic(1, 6e5, {16, 4}), {0.1, 0}, 1000);
  FrequencyCoefficients c(*at.film, at.motion, at.states);
  EXPECT_THROW((void)c.at(0), core::InputError);
}

}  // namespace
}  // namespace whirl::film::testing
