#pragma once
// An isothermal film of gas in a whole circular bore, fed by orifices or by itself.

#include <array>
#include <vector>

#include "whirl/film/bore.hpp"
#include "whirl/film/facts.hpp"
#include "whirl/thermal/orifice.hpp"

namespace whirl::deck {
template <class S>
class Description;
}

namespace whirl::film {

/// Simple orifices without pockets (inherent compensation), evenly spaced around the bore.
struct OrificeRow {
  int count = 8;
  double z = 0;         // m, from the mid-plane of the bearing
  double angle = 0;     // rad, of the first one, from +x
  double diameter = 0;  // m
  double supply = 0;    // Pa, absolute
  friend bool operator==(const OrificeRow&, const OrificeRow&) = default;
};

/// The compressible Reynolds equation with the pressure at the nodes and behind the orifices as states.
/// Source: Skarolek (2011) secs. 3.1-3.3 with the errata kept by this project.
struct Gas {
  static constexpr std::string_view key = "gas", text = "compressible isothermal Reynolds equation, fed by orifices";
  /// What stands between an orifice and the node that it feeds. rim: the pressure of the point source at the rim of the
  /// orifice. node: that of the node, which grows without bound as the mesh becomes finer; to show just this.
  enum class Source { rim, node };
  States states = States::dynamic;
  Source source = Source::rim;
  std::array<int, 2> cells = {96, 32};  // -, intervals around and along the bearing
  bool tilt = false;                    // -, false: tilt is ignored and moments are zero
  double ambient = 101325;              // Pa, absolute, at both ends
  double temperature = 300;             // K, of the film and of the supply
  double gas_constant = 286.7;          // J/(kg K)
  double heat_ratio = 1.4;              // -
  std::vector<OrificeRow> orifices;     // none: a self-acting bearing
  friend bool operator==(const Gas&, const Gas&) = default;
};

void describe(deck::Description<OrificeRow>& d);
void describe(deck::Description<Gas>& d);
[[nodiscard]] Facts facts_of(const Gas& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const Gas& options, const Lubricant& lubricant);
void refine(Gas& options, const std::array<double, 2>& factor);

}  // namespace whirl::film
