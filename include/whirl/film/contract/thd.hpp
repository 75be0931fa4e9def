#pragma once
// A film with heat: pressure, and temperatures across the film, at the nodes of rigid pads.

#include <array>
#include <optional>

#include "whirl/film/contract/bore.hpp"
#include "whirl/film/contract/facts.hpp"
#include "whirl/film/contract/turbulence.hpp"
#include "whirl/thermal/fluid.hpp"

namespace whirl::deck {
template <class S>
class Description;
}

namespace whirl::film {

/// A wall of a film with heat.
struct HeatedWall {
  enum class Type { isothermal, adiabatic };
  Type type = Type::adiabatic;
  double temperature = 323.15;  // K, isothermal
  friend bool operator==(const HeatedWall&, const HeatedWall&) = default;
};

/// Reynolds' equation with a viscosity that follows the temperature, and the energy equation in layers across the film.
/// Source: Dowson (1962); Skarolek (2011) ch. 4 with the errata kept by this project.
struct Thd {
  static constexpr std::string_view key = "thd",
                                    text = "two-dimensional Reynolds equation whose viscosity follows the temperature";
  enum class Cavitation { half_sommerfeld, none };
  Cavitation cavitation = Cavitation::half_sommerfeld;
  States states = States::condensed;  // dynamic: temperatures follow the motion in time
  Turbulence turbulence = Turbulence::laminar;
  std::array<int, 2> cells = {60, 16};                 // -, intervals around x along each pad
  int layers = 1;                                      // -, across the film
  bool tilt = false;                                   // -, false: tilt is ignored and moments are zero
  double feed = 313.15;                                // K, of oil that enters
  std::optional<thermal::ViscosityOptions> viscosity;  // constant, that of the lubricant, if absent
  double heat_capacity = 2000;                         // J/(kg K)
  double conductivity = 0.13;                          // W/(m K)
  HeatedWall bush, journal;
  friend bool operator==(const Thd&, const Thd&) = default;
};

void describe(deck::Description<HeatedWall>& d);
void describe(deck::Description<Thd>& d);
[[nodiscard]] Facts facts_of(const Thd& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const Thd& options, const Lubricant& lubricant);
void refine(Thd& options, const std::array<double, 2>& factor);

}  // namespace whirl::film
