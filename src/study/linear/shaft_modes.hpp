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
  int id = -1;                                               // the same for the same mode at other speeds

  [[nodiscard]] std::vector<std::complex<double>> both() const {
    std::vector<std::complex<double>> all = x;
    all.insert(all.end(), y.begin(), y.end());
    return all;
  }
  [[nodiscard]] std::array<std::vector<std::complex<double>>*, 4> columns() { return {&x, &y, &slope_x, &slope_y}; }
};

/// The `count` vibrating modes of lowest frequency up to `max_frequency` [rad/s], the largest displacement one, and in
/// `missed` what solve::Stability::missed says of their search. Collective.
[[nodiscard]] std::vector<ShaftMode> shaft_modes(system::RotorSystem& system, Vec equilibrium, int count,
                                                 double max_frequency, int& missed);

/// Modes of one speed as numbers, to send them between ranks, and back.
[[nodiscard]] std::vector<double> pack(std::vector<ShaftMode> modes);
[[nodiscard]] std::vector<ShaftMode> unpack(const std::vector<double>& flat);

}  // namespace whirl::study
