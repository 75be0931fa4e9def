#pragma once
// Modes of a machine with their shapes along the shaft.

#include <array>
#include <complex>
#include <utility>
#include <vector>

#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

/// A mode with its shape along the shaft.
struct ShaftMode {
  std::complex<double> lambda;
  std::vector<std::complex<double>> x, y, slope_x, slope_y;  // per node
  bool undamped = false;                                     // its real part is rounding
  double participation = 1;  // of the machine: its largest motion over that of any state
  double condition = 0;      // of the eigenvalue, as of spectral::Mode; not a number: not known or not asked for
  int multiplicity = 1, vectors = 1;
  bool extra = false;  // it is listed for nothing but its growth, above those asked for
  int id = -1;         // the same for the same mode at other speeds
  /// Another mode has the same eigenvalue but for rounding, and they have no sense of whirl in common: any combination
  /// of the two is a mode. These are the two that turn most, backward first.
  bool either = false;
  double blur = 0;        // as of spectral::Mode; not sent to other ranks
  bool put_back = false;  // it is none of those asked for, but grows at a speed beside this one

  [[nodiscard]] bool grows() const { return !undamped && lambda.real() > 0; }
  [[nodiscard]] std::vector<std::complex<double>> both() const {
    std::vector<std::complex<double>> all = x;
    all.insert(all.end(), y.begin(), y.end());
    return all;
  }
  [[nodiscard]] std::array<std::vector<std::complex<double>>*, 4> columns() { return {&x, &y, &slope_x, &slope_y}; }
  void members(auto& archive) {
    archive(lambda, undamped, participation, multiplicity, vectors, condition, extra, either, x, y, slope_x, slope_y);
  }
};

/// What a search looked at and found beside the modes.
struct ModeSearch {
  double frequency = 0, decay = 0;  ///< region of a count [rad/s, 1/s]; zero: nothing was counted
  double counted = 0;               ///< eigenvalues there, both of each pair
  double missed = 0;                ///< as solve::Stability::missed
  double gave_up = 0;               ///< 1: fewer modes than asked for, and it did not look on
  /// Of the eigenvalue nearest to zero, if it is multiple without as many vectors; else 0. Known with condition
  /// numbers.
  double rest_multiplicity = 0, rest_vectors = 0;
  double listed = 0;                               ///< the first modes: those asked for, and all that grow
  std::vector<std::complex<double>> overdamped{};  ///< imag >= 0, the slowest first
  std::vector<std::complex<double>> mesh_waves{};  ///< lightly damped or growing ones, which are none of the modes
  void members(auto& archive) {
    archive(frequency, decay, counted, missed, gave_up, rest_multiplicity, rest_vectors, listed, overdamped,
            mesh_waves);
  }
};

/// The modes in which the machine takes part, the largest displacement one: first those that grow without oscillation
/// (real eigenvalues above zero), then the `count` lowest ones that vibrate up to `max_frequency` [rad/s], by
/// frequency, then all others that grow, whatever their frequency. These are `search.listed`. Up to `beyond` more that
/// vibrate follow, to recognise modes by. A mode whose damping ratio exceeds spectral::overdamped_above does not count
/// as one that vibrates: it stands in `search.overdamped`, with real eigenvalues below zero.
///
/// A motion of the films alone is none of these unless it grows: states are measured in their scales, and where shaft
/// and pedestals do less than `least_participation` of what the films do, eigenvalues of films that carry their content
/// along are left to rounding. `condition`: with condition numbers. Collective.
[[nodiscard]] std::vector<ShaftMode> shaft_modes(system::RotorSystem& system, Vec equilibrium, int count, int beyond,
                                                 double max_frequency, ModeSearch& search, bool condition = false);
inline constexpr double least_participation = 1e-3;

/// What shaft_modes() found at one speed, as ranks send it each other: without identities.
using FoundModes = std::pair<std::vector<ShaftMode>, ModeSearch>;

}  // namespace whirl::study
