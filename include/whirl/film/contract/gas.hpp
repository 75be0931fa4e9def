#pragma once
// An isothermal film of gas in any bore, fed by orifices or by itself.

#include <array>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "whirl/film/contract/bore.hpp"
#include "whirl/film/contract/facts.hpp"
#include "whirl/thermal/orifice.hpp"

namespace whirl::deck {
template <class S>
class Description;
}

namespace whirl::film {

/// Recess of the bore around an orifice.
struct Pocket {
  double diameter = 0;  // m
  double depth = 0;     // m, below the bore
  friend bool operator==(const Pocket&, const Pocket&) = default;
};

/// Orifices, evenly spaced around the bore, with or without pockets.
struct OrificeRow {
  /// What flows, by ideal nozzles; h_f = h + depth of the pocket, Re by the flow itself.
  enum class Law {
    thickness,       // 0.85 (1 - exp(-8.2 h_f/d)) of the orifice, eq. (3.8)
    reynolds,        // times 1 - exp(-0.001 Re h_f/(h + 4 depth)), eqs. (3.9)-(3.10)
    curtain,         // 1.05 (1 - exp(-0.005 Re)) of the curtain pi d h, eqs. (3.12)-(3.13) at the orifice
    two_restrictors  // `reynolds` into the pocket, then `curtain` at its rim, eqs. (3.9)-(3.13)
  };
  int count = 8;
  double z = 0;         // m, from the mid-plane of the bearing
  double angle = 0;     // rad, of the first one, from +x
  double diameter = 0;  // m
  double supply = 0;    // Pa, absolute
  Law law = Law::thickness;
  std::optional<Pocket> pocket = {};
  friend bool operator==(const OrificeRow&, const OrificeRow&) = default;
};

/// Arcs of a larger radius that touch each other, in place of a circle.
struct Lobes {
  int count = 3;
  double preload = 0.5;                   // -, 1 - clearance/(clearance of a lobe)
  double angle = 1.5 * std::numbers::pi;  // rad, of the middle of the first one
  friend bool operator==(const Lobes&, const Lobes&) = default;
};

/// The compressible Reynolds equation with the pressure at the nodes and behind the orifices as states.
/// Source: Skarolek (2011) secs. 3.1-3.3 with the errata kept by this project.
struct Gas {
  static constexpr std::string_view key = "gas", text = "compressible isothermal Reynolds equation, fed by orifices";
  /// What stands between an orifice and the node that it feeds. rim: the pressure of the point source at the rim of the
  /// orifice. node: that of the node, which grows without bound as the mesh becomes finer; to show just this.
  enum class Source { rim, node };
  /// What rarefaction makes of the flow by pressure, times 1 + 6 Kn (first: Burgdorfer 1959) or 1 + 6 Kn + 6 Kn^2
  /// (second: Hsia and Domoto 1983); Kn = mu sqrt(pi r T/2)/(p h).
  enum class Slip { none, first, second };
  States states = States::dynamic;
  Source source = Source::rim;
  Slip slip = Slip::none;
  std::array<int, 2> cells = {96, 32};  // -, intervals around and along the bearing
  bool tilt = false;                    // -, false: tilt is ignored and moments are zero
  double ambient = 101325;              // Pa, absolute, at both ends
  double temperature = 300;             // K, of the film and of the supply
  double gas_constant = 286.7;          // J/(kg K)
  double heat_ratio = 1.4;              // -
  std::vector<OrificeRow> orifices;     // none: a self-acting bearing
  std::optional<Lobes> lobes = {};      // of a cylindrical bore
  std::vector<Groove> grooves = {};     // axial ones
  friend bool operator==(const Gas&, const Gas&) = default;
};

void describe(deck::Description<Pocket>& d);
void describe(deck::Description<Lobes>& d);
void describe(deck::Description<OrificeRow>& d);
void describe(deck::Description<Gas>& d);
[[nodiscard]] Facts facts_of(const Gas& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const Gas& options, const Lubricant& lubricant);
void refine(Gas& options, const std::array<double, 2>& factor);

}  // namespace whirl::film
