#pragma once
// Modes of a machine with their shapes along the shaft.

#include <array>
#include <complex>
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
  int id = -1;  // the same for the same mode at other speeds

  [[nodiscard]] std::vector<std::complex<double>> both() const {
    std::vector<std::complex<double>> all = x;
    all.insert(all.end(), y.begin(), y.end());
    return all;
  }
  [[nodiscard]] std::array<std::vector<std::complex<double>>*, 4> columns() { return {&x, &y, &slope_x, &slope_y}; }
};

/// What a search by transfer functions looked at and found.
struct ModeSearch {
  double frequency = 0, decay = 0;  ///< its region [rad/s, 1/s]; zero: no such search
  double counted = 0;               ///< eigenvalues there, both of each pair
  double missed = 0;                ///< as solve::Stability::missed
  double gave_up = 0;               ///< 1: fewer modes than asked for, and it did not look on
  /// Of the eigenvalue nearest to zero, if it is multiple without as many vectors; else 0. Known with condition
  /// numbers.
  double rest_multiplicity = 0, rest_vectors = 0;

  static constexpr std::size_t size = 7;  ///< as numbers
};

/// The `count` vibrating modes of lowest frequency up to `max_frequency` [rad/s] in which the machine takes part, the
/// largest displacement one. A motion of the films alone is none of these: states are measured in their scales, and
/// where shaft and pedestals do less than `least_participation` of what the films do, eigenvalues of films that carry
/// their content along are left to rounding. `condition`: with condition numbers. Collective.
[[nodiscard]] std::vector<ShaftMode> shaft_modes(system::RotorSystem& system, Vec equilibrium, int count,
                                                 double max_frequency, ModeSearch& search, bool condition = false);
inline constexpr double least_participation = 1e-3;

/// Modes of one speed as numbers, to send them between ranks, and back.
[[nodiscard]] std::vector<double> pack(std::vector<ShaftMode> modes, const ModeSearch& search);
[[nodiscard]] std::vector<ShaftMode> unpack(const std::vector<double>& flat, ModeSearch& search);

}  // namespace whirl::study
