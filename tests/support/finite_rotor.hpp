#pragma once
// The rotor of inputs/compliant_rotor/finite_curve.yaml: half of it on one compliant bearing of finite length.

#include <Eigen/Core>
#include <numbers>

#include "support/half_rotor.hpp"
#include "system/start.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/newton.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::test {

/// Omega* = 1 [rad/s].
inline constexpr double finite_speed_scale = 160;

/// F0* = 1, L/D = 1, B = 0.1, a* = 0.2, film mesh of `around` x `along` cells.
inline system::Train finite_rotor(int around, int along) {
  film::CompliantFinite film;
  film.compliance = 0.1;
  film.reference_speed = finite_speed_scale;
  film.cells = {around, along};
  film.differences = film::Compliant::Differences::central;
  system::Train t = half_rotor(film, 5e-6);
  t.supports[0].name = "half";
  return t;
}

/// The equilibrium at the speed of `s` [rad/s], reached from a slow rotor, held for a turn: a first guess of the cycle.
inline solve::Cycle finite_rotor_at_rest(system::RotorSystem& s, double speed) {
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  for (const double part : {0.45, 0.65, 0.85, 1.0}) {
    s.set_parameter(part * speed);
    solve::NewtonOptions newton;
    newton.max_iterations = 40;
    core::require(solve::find_equilibrium(s, x.get(), newton).converged, "no equilibrium");
  }
  s.set_forcing(true);
  const std::vector<double> whole = s.gather(x.get());
  return {{0, 1},
          Eigen::Map<const Eigen::VectorXd>(whole.data(), static_cast<Eigen::Index>(whole.size())),
          2 * std::numbers::pi / speed,
          speed};
}

}  // namespace whirl::test
