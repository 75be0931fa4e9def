#pragma once
// Flows of two and three states whose motions are known from the literature: what a motion is called can be tried on
// them.

#include <array>
#include <memory>
#include <optional>
#include <string_view>

#include "whirl/deck/description.hpp"
#include "whirl/system/brusselator.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::system {

/// dx/dt = sigma (y - x), dy/dt = x (rho - z) - y, dz/dt = x y - beta z. Shows (x, z). Source: Lorenz (1963).
struct Lorenz {
  static constexpr std::string_view key = "lorenz", text = "three modes of convection, Lorenz (1963)";
  double sigma = 10, rho = 28, beta = 8.0 / 3;
};
void describe(deck::Description<Lorenz>& d);

/// dx/dt = -y - z, dy/dt = x + a y, dz/dt = b + z (x - c). Shows (x, y). Source: Rossler (1976).
struct Rossler {
  static constexpr std::string_view key = "rossler", text = "a flow with one quadratic term, Rossler (1976)";
  double a = 0.2, b = 0.2, c = 5.7;
};
void describe(deck::Description<Rossler>& d);

/// x'' + damping x' + linear x + cubic x^3 = amplitude cos(frequency t). Shows (x, x'). A motion of it takes its
/// frequency as speed. Source: Duffing (1918); Guckenheimer and Holmes (1983) sec. 2.2.
struct Duffing {
  static constexpr std::string_view key = "duffing", text = "a forced oscillator with a cubic spring, Duffing (1918)";
  double damping = 0.3, linear = -1, cubic = 1, amplitude = 0.5;
  double frequency = 1.2;  ///< rad/s
  [[nodiscard]] std::optional<double> forced_at() const { return frequency; }
};
void describe(deck::Description<Duffing>& d);

/// F = dx/dt - f(x), dimensionless, time in seconds; the first rank holds all states. Collective.
[[nodiscard]] std::unique_ptr<Plant> make_system(MPI_Comm comm, OptionsAlong<Lorenz> along);
[[nodiscard]] std::unique_ptr<Plant> make_system(MPI_Comm comm, OptionsAlong<Rossler> along);
[[nodiscard]] std::unique_ptr<Plant> make_system(MPI_Comm comm, OptionsAlong<Duffing> along);

}  // namespace whirl::system
