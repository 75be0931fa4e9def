// Stiffness and damping by enforced harmonic motion.
#include "whirl/film/use/enforced.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "film/algebra/film_matrix.hpp"
#include "film/gas_cases.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film::testing {
namespace {

using std::numbers::pi;

Gas bearing_b(std::array<int, 2> cells) {
  Gas out = aerostatic(2, 6e5, cells);
  out.tilt = true;
  return out;
}
// 0.23 clearances deep at 2000 rad/s, as under 5 kg.
SolvedGas loaded(std::array<int, 2> cells) {
  return solved(spindle(), bearing_b(cells), {0.016, -0.228}, 2000);
}
double apart(const EnforcedForces& f, const PortCoefficients& c, std::size_t port, double omega) {
  double out = 0, size = 0;
  const std::size_t first = port < 2 ? 0 : 2;
  for (std::size_t i = first; i < first + 2; ++i) {
    out = std::max(out, std::hypot(f.stiffness[i] - c.stiffness[i][port], omega * (f.damping[i] - c.damping[i][port])));
    size = std::max(size, std::hypot(c.stiffness[i][port], omega * c.damping[i][port]));
  }
  return out / size;
}

// As the amplitude falls all entries tend to those by perturbation, with its square.
TEST(Enforced, OfSmallAmplitudesIsThePerturbation) {
  SolvedGas at = loaded({24, 8});
  const double c = spindle().clearance, length = spindle().length;
  for (const double nu : {0.05, 1.0, 5.0}) {
    const double omega = nu * 2000;
    const PortCoefficients k = port_coefficients(*at.film, at.motion, at.states, omega);
    Enforced enforced(*at.film, at.motion, at.states, omega);
    for (std::size_t port = 0; port < 4; ++port) {
      const double unit = port < 2 ? 1 : 1 / (2 * length);
      const double large = apart(enforced.along(port, 0.05 * c * unit), k, port, omega);
      const double small = apart(enforced.along(port, 0.025 * c * unit), k, port, omega);
      EXPECT_LT(small, 1e-3) << nu << ' ' << port;
      EXPECT_NEAR(std::log2(large / small), 2, 0.05) << nu << ' ' << port;
      EXPECT_LT(apart(enforced.along(port, 1e-3 * c * unit), k, port, omega), 3e-6) << nu << ' ' << port;
    }
  }
}

// Forces by the trapezoidal rule, step by step until the film repeats itself.
EnforcedForces by_steps(SolvedGas& at, std::size_t port, double amplitude, double omega, int steps) {
  Film& film = *at.film;
  const auto n = static_cast<Eigen::Index>(at.states.size());
  const auto w = static_cast<std::size_t>(film.ports()[port]);
  const auto moved = [&](double phase) {
    JournalMotion m = at.motion;
    m.position[w] += amplitude * std::sin(phase);
    m.velocity[w] += amplitude * omega * std::cos(phase);
    return m;
  };
  const double dt = 2 * pi / (omega * steps);
  std::vector<double> s = at.states;
  const std::vector<double> still(s.size(), 0.0);
  StateResponse r;
  const auto view = [&](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), n); };
  // dg/ds' is one for the pressures and zero for what is behind orifices.
  Eigen::VectorXd has_rate = Eigen::VectorXd::Zero(n);
  film.evaluate(moved(0), s, still, Need::tangents, r);
  for_entries(film.whole(), film.whole().d_rates, r.d_rates, [&](int i, int, double v) { has_rate(i) = v; });
  FilmMatrix<double> matrix(film.whole(), film.whole().d_states);
  // Rows without rates are met at the new point; those with, between both.
  Eigen::VectorXd before = view(r.residual);
  EnforcedForces out;
  for (int k = 1, rounds = 6; k <= rounds * steps; ++k) {
    const JournalMotion m = moved(2 * pi * k / steps);
    const Eigen::VectorXd old = view(s);
    for (int newton = 0; newton < 20; ++newton) {
      film.evaluate(m, s, still, Need::tangents, r);
      const Eigen::VectorXd mean = 0.5 * (view(r.residual) + before);
      const Eigen::VectorXd left = (has_rate.array() > 0).select((view(s) - old) / dt + mean, view(r.residual));
      Eigen::MatrixXd a = Eigen::MatrixXd(matrix.filled(r.d_states));
      for (Eigen::Index i = 0; i < n; ++i)
        if (has_rate(i) > 0) {
          a.row(i) *= 0.5;
          a(i, i) += 1 / dt;
        }
      const Eigen::VectorXd change = a.partialPivLu().solve(left);
      for (Eigen::Index i = 0; i < n; ++i) s[static_cast<std::size_t>(i)] -= change(i);
      if (change.cwiseAbs().maxCoeff() < 1e-7) break;
    }
    film.evaluate(m, s, still, Need::force, r);
    before = view(r.residual);
    if (k <= (rounds - 1) * steps) continue;
    for (std::size_t i = 0; i < film.ports().size(); ++i) {
      const double force = r.journal.force[static_cast<std::size_t>(film.ports()[i])];
      out.stiffness[i] -= 2 * force * std::sin(2 * pi * k / steps) / (steps * amplitude);
      out.damping[i] -= 2 * force * std::cos(2 * pi * k / steps) / (steps * amplitude * omega);
    }
  }
  return out;
}

// Half a clearance, where what is left of the linear picture is little.
TEST(Enforced, OfALargeAmplitudeIsTheLimitOfStepsInTime) {
  Gas few = aerostatic(1, 6e5, {16, 4});
  few.tilt = true;
  SolvedGas at = solved(spindle(), few, {0.016, -0.228}, 2000);
  const double amplitude = 0.5 * spindle().clearance, omega = 3000;
  Enforced enforced(*at.film, at.motion, at.states, omega);
  const EnforcedForces found = enforced.along(1, amplitude);
  EXPECT_LT(found.tail, 1e-6);
  EXPECT_GT(found.distortion, 0.05);
  const PortCoefficients linear = port_coefficients(*at.film, at.motion, at.states, omega);
  EXPECT_GT(apart(found, linear, 1, omega), 0.05);
  double before = 0;
  for (const int steps : {32, 64, 128}) {
    const EnforcedForces s = by_steps(at, 1, amplitude, omega, steps);
    double error = 0;
    for (std::size_t i = 0; i < 2; ++i)
      error =
          std::max(error, std::hypot(s.stiffness[i] - found.stiffness[i], omega * (s.damping[i] - found.damping[i])));
    error /= found.stiffness[1];
    if (before > 0) {
      EXPECT_NEAR(std::log2(before / error), 2, 0.15) << steps;
    }
    before = error;
  }
  EXPECT_LT(before, 1e-3);
}

// Films without states answer at once; those of the deck's coefficients, whatever the amplitude.
TEST(Enforced, OfFilmsWithoutStates) {
  Linear options;
  options.stiffness = {2e7, 3e6, -1e6, 1e7};
  options.damping = {5e3, 1e2, -1e2, 4e3};
  const auto linear = make_film(spindle(), options, air());
  Enforced enforced(*linear, {}, {}, 1000);
  for (std::size_t port = 0; port < 2; ++port) {
    const EnforcedForces f = enforced.along(port, 5e-6);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(f.stiffness[i], options.stiffness[2 * i + port], 1e-8 * 2e7);
      EXPECT_NEAR(f.damping[i], options.damping[2 * i + port], 1e-8 * 5e3);
    }
    EXPECT_LT(f.distortion, 1e-7);
  }
}

TEST(Enforced, RefusesWhatIsNoMotion) {
  SolvedGas at = loaded({16, 4});
  EXPECT_THROW(Enforced(*at.film, at.motion, at.states, 0), core::InputError);
  Enforced enforced(*at.film, at.motion, at.states, 1000);
  EXPECT_THROW((void)enforced.along(0, 0), core::InputError);
  // Through the wall.
  EXPECT_THROW((void)enforced.along(1, spindle().clearance), core::DomainError);
}

}  // namespace
}  // namespace whirl::film::testing
