#pragma once
// Reynolds' equation in two dimensions on the rigid pads of any bore.

#include <array>
#include <vector>

#include "whirl/film/contract/bore.hpp"
#include "whirl/film/contract/facts.hpp"
#include "whirl/film/contract/turbulence.hpp"

namespace whirl::deck {
template <class S>
class Description;
}

namespace whirl::film {

/// The pressure is condensed, unless the film conserves its mass and holds what its gap contains as states.
/// Source: Gavalas (2022) sec. 2.3 with the errata kept by this project; mass_conserving: Jakobsson and Floberg (1957),
/// Olsson (1965), Elrod and Adams (1974).
struct Reynolds {
  static constexpr std::string_view key = "reynolds", text = "two-dimensional Reynolds equation, pressure condensed";
  enum class Cavitation { half_sommerfeld, reynolds, mass_conserving, none };
  using States = film::States;
  Cavitation cavitation = Cavitation::reynolds;
  double edge_fill = 1.0;             // -, part of the gap that is full of oil where it enters a pad (mass_conserving)
  States states = States::condensed;  // of a mass_conserving film: does its cavity fill and empty in time?
  double bulk_modulus = 1.5e9;        // Pa, of the oil where the gap is full, of a film with dynamic states
  Turbulence turbulence = Turbulence::laminar;
  Inlet inlet;                          // of a cylindrical bore
  std::array<int, 2> cells = {60, 16};  // -, intervals around x along each pad
  bool tilt = false;                    // -, false: tilt is ignored and moments are zero
  std::vector<Groove> grooves;          // of a cylindrical bore
  std::vector<Hole> holes;              // of any bore
  friend bool operator==(const Reynolds&, const Reynolds&) = default;
};

void describe(deck::Description<Reynolds>& d);
[[nodiscard]] Facts facts_of(const Reynolds& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const Reynolds& options, const Lubricant& lubricant);
void refine(Reynolds& options, const std::array<double, 2>& factor);

}  // namespace whirl::film
