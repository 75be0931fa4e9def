#pragma once
// The Brusselator: a chemical oscillator in a tube, no rotor.

#include <functional>
#include <memory>
#include <optional>
#include <string_view>

#include "whirl/deck/description.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::system {

/// Options of a kind of system as a function of the parameter of a branch.
template <class Options>
struct OptionsAlong {
  std::function<Options(double)> at;
  double value = 0;      ///< to start with
  double magnitude = 1;  ///< typical size, for the steps of difference quotients
};

/// du/dt = (Du/L^2) u_zz + u^2 v - (B + 1) u + A, dv/dt = (Dv/L^2) v_zz - u^2 v + B u on 0 < z < 1 with u = A, v = B/A
/// at both ends; all dimensionless, time in seconds. A force adds amplitude cos(frequency t) to du/dt in all of the
/// tube; a motion takes its frequency as speed. Source: van de Vrande (2001), Sec. 3.2, after Holodniok et al. (1987);
/// of the force, Tomita and Kai (1978).
struct Brusselator {
  static constexpr std::string_view key = "brusselator";
  static constexpr std::string_view text = "a chemical oscillator in a tube, van de Vrande (2001), Sec. 3.2";
  int cells = 32;          ///< equal intervals along the tube, second differences
  double length = 1;       ///< L
  double a = 2, b = 5.45;  ///< A, B
  double diffusion_u = 0.008, diffusion_v = 0.004;
  double amplitude = 0;  ///< 0: no force
  double frequency = 1;  ///< rad/s
  [[nodiscard]] std::optional<double> forced_at() const {
    return amplitude > 0 ? std::optional(frequency) : std::nullopt;
  }
};
void describe(deck::Description<Brusselator>& d);

/// State: u_1, v_1, u_2, v_2, ... at the inner points, whole points on each rank; F = dx/dt - f(x). It shows (u, v) in
/// the middle of the tube. Collective.
[[nodiscard]] std::unique_ptr<Plant> make_system(MPI_Comm comm, OptionsAlong<Brusselator> along);

}  // namespace whirl::system
