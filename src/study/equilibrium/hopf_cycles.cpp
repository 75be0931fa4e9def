#include "study/equilibrium/hopf_cycles.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

#include "study/bars/summary_bars.hpp"
#include "study/state_rows.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/harmonic_cycle.hpp"

namespace whirl::study {

using core::check;

solve::MotionSize motion_of_places(system::Plant& system) {
  const system::ShownPlaces places = system.places();
  if (!(std::reduce(places.clearances.begin(), places.clearances.end()) > 0)) return solve::largest_state;
  core::Vector scale = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE),
               rows = core::duplicate(scale.get());
  system.scales(scale.get(), rows.get());
  return [states = std::make_shared<StateRows>(system), unit = rows_of(scale.get()),
          clearances = places.clearances](const Eigen::VectorXd& v) {
    // Places are affine in the state.
    const auto still = states->shown(Eigen::VectorXd::Zero(v.size())), moved = states->shown(unit.cwiseProduct(v));
    double most = 0;
    for (std::size_t k = 0; k < moved.size(); ++k)
      if (clearances[k] > 0)
        most = std::max(
            most, std::hypot(moved[k].position[0] - still[k].position[0], moved[k].position[1] - still[k].position[1]) /
                      clearances[k]);
    return most;
  };
}

CriticalMotion critical_motion(system::Plant& system, Vec x, double omega) {
  CriticalMotion out{solve::critical_vector(system, x, omega), 1, {}};
  for (const auto& e : out.q) out.largest = std::max(out.largest, std::abs(e));
  double most = out.largest;
  const system::ShownPlaces places = system.places();
  core::Vector scale = core::duplicate(x), rows = core::duplicate(x);
  system.scales(scale.get(), rows.get());
  const std::vector<double> rest = system.gather(x), unit = core::gather(scale.get());
  // Outputs are smooth functions of the state: small motions show their derivative.
  const double h = 1e-6 / out.largest;
  const auto moved = [&](bool later) {
    std::vector<double> at = rest;
    for (std::size_t i = 0; i < at.size(); ++i) at[i] += h * unit[i] * (later ? -out.q[i].imag() : out.q[i].real());
    return system.shown(at.data());
  };
  const auto still = system.shown(rest.data()), first = moved(false), quarter = moved(true);
  double largest_place = 0;
  for (std::size_t k = 0; k < places.clearances.size() && k < still.size(); ++k) {
    if (!(places.clearances[k] > 0)) continue;
    // z = x + i y = f exp(i angle) + g exp(-i angle) is a at angle 0 and b a quarter later.
    const auto z = [&](const auto& p) {
      return std::complex<double>(p[k].position[0] - still[k].position[0], p[k].position[1] - still[k].position[1]);
    };
    const std::complex<double> a = z(first), b = z(quarter), i(0, 1);
    const double axis = (std::abs(a - i * b) + std::abs(a + i * b)) / (2 * h * places.clearances[k]);
    if (axis <= largest_place) continue;
    largest_place = axis;
    out.place = places.names[k];
  }
  if (largest_place > 0) most = largest_place;
  for (auto& e : out.q) e /= most;
  out.largest /= most;
  return out;
}

double BirthOfCycles::doubt(bool kinks) const {
  const double apart = std::abs(curvature - smaller);
  if (kinks) return smaller * curvature > 0 ? 0 : apart;
  // p_0 + c A^2 + d A^4 has slopes c + 5/16 d and c + 5/4 d over A^2, A the largest amplitude.
  return 4 * apart / 3;
}

std::optional<BirthOfCycles> birth_of_cycles(system::Plant& system, Vec x, double omega, double parameter_scale,
                                             int harmonics, double largest) {
  if (core::size_of(system.comm()) != 1) return {};
  const double parameter = system.parameter();
  const CriticalMotion motion = critical_motion(system, x, omega);
  for (int halvings = 0; halvings < 4; ++halvings, largest /= 2) {
    std::array<double, 3> p{};
    BirthOfCycles out;
    const bool found = has_answer([&] {
      solve::HarmonicCycle cycles(system, x, omega, motion.q, harmonics, parameter_scale);
      for (std::size_t k = 0; k < 3; ++k) {
        const double a = largest * std::exp2(static_cast<double>(k) - 2);
        out.amplitudes[k] = a;
        p[k] = cycles.at_amplitude(a, {})[0] / parameter_scale;
      }
    });
    system.set_parameter(parameter);
    if (!found) continue;
    const auto slope = [&](std::size_t k) {
      const double a = out.amplitudes[k], b = out.amplitudes[k + 1];
      return (p[k + 1] - p[k]) / (b * b - a * a);
    };
    out.curvature = slope(1);
    out.smaller = slope(0);
    return out;
  }
  return {};
}

}  // namespace whirl::study
