#pragma once
// What an orifice gives to a film of gas, with or without a pocket, and where.

#include <array>
#include <cmath>
#include <vector>

#include "whirl/film/contract/bore.hpp"
#include "whirl/film/contract/gas.hpp"

namespace whirl::film {

/// The first orifice that reaches over an end of the bearing, lies beside the pads of a bore with pads or overlaps
/// another one, pockets counted; none of a film whose orifices fit.
[[nodiscard]] Misplaced misplaced_orifice(const Gas& gas, const Geometry& geometry);

/// The mesh of a film of gas: lines of nodes around the bore, and nodes of a line between its ends.
struct GasMesh {
  int lines, inner;
  double dx, dz;  // m
  double dtheta, start, length;
  [[nodiscard]] int at(int line, int place) const { return line * inner + place; }
};

/// Whether two places so far apart in one direction lie within a cell of that size: as close in both, orifices feed the
/// same nodes.
[[nodiscard]] inline bool in_one_cell(double apart, double cell) {
  return std::abs(apart) / cell < 1.0 - 1e-9;
}

/// kg/s, and its derivatives in two unknowns of a feed and in the thickness of the film there.
struct GasFlow {
  double mass = 0;
  std::array<double, 2> by{};
  double by_thickness = 0;
};

/// One orifice. Its unknowns: the pressure at the rim [Pa], and of an orifice with a pocket another one, that of the
/// pocket [Pa] where the rim resists too, else the flow into the film [kg/s].
///
///     p_o^2 - sum_a w_a p_a^2 + 12 mu r T m/(pi h^3) ln(rim/reach) = 0,   V/(r T) d p_pocket/dt = m_in - m
///
/// with the flow m into the film spread over nodes a by weights w_a: linearly over those of its cell, and of a pocket
/// over those along its rim. reach is where the field ln(r) of the source equals what the mesh reads for it.
class GasFeed {
public:
  enum class Kind { simple, shallow, deep };
  /// Number k of the orifices of its row.
  GasFeed(const OrificeRow& row, int k, const Gas& gas, double viscosity, const GasMesh& mesh);

  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] int unknowns() const { return kind_ == Kind::simple ? 1 : 2; }
  /// The flow into the film, from the unknowns and the thickness there; `uses` says which unknowns it depends on.
  [[nodiscard]] GasFlow into_film(const std::array<double, 2>& unknowns, double thickness) const;
  [[nodiscard]] std::array<bool, 2> uses() const { return {kind_ != Kind::shallow, kind_ != Kind::simple}; }
  /// What a pocket gets less what it gives.
  [[nodiscard]] GasFlow into_pocket(const std::array<double, 2>& unknowns, double thickness) const;
  /// Which of the unknowns is the pressure in the pocket, and what a pascal there holds [kg/Pa].
  [[nodiscard]] int pocket_pressure() const { return kind_ == Kind::shallow ? 0 : 1; }
  [[nodiscard]] double capacity() const { return capacity_; }
  /// Unknowns at which a film with `pull` [Pa^2] without it and `resists` [Pa^2 s/kg] behind the rim takes what it
  /// gets.
  [[nodiscard]] std::array<double, 2> steady(double pull, double resists, double thickness) const;

  struct Part {
    int node;
    double weight;
  };
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] double angle() const { return angle_; }
  [[nodiscard]] double z() const { return z_; }
  /// Line of nodes beside it.
  [[nodiscard]] int line() const { return line_; }
  [[nodiscard]] double supply() const { return row_.supply; }
  [[nodiscard]] double rim() const { return rim_; }
  /// The same of a pocket; zero without.
  [[nodiscard]] double pocket_rim() const { return kind_ == Kind::simple ? 0.0 : rim_; }
  /// ln(rim/reach).
  [[nodiscard]] double distance() const { return distance_; }
  /// Typical flow, of the choked orifice [kg/s].
  [[nodiscard]] double scale() const;
  /// Whether both stand in the cells of the mesh at one place.
  [[nodiscard]] bool crowds(const GasFeed& other, const GasMesh& mesh) const;

private:
  struct Passage {
    double mass, by_before, by_behind, by_thickness;
  };
  [[nodiscard]] Passage orifice(double behind, double thickness) const;
  [[nodiscard]] Passage curtain(double before, double behind, double diameter, double thickness) const;
  void spread(const GasMesh& mesh, bool ring);

  OrificeRow row_;
  thermal::PerfectGas gas_;
  double temperature_, viscosity_;
  Kind kind_;
  double depth_, rim_, capacity_ = 0;
  double angle_, z_, distance_ = 0;
  int line_ = 0;
  std::vector<Part> parts_;
};

}  // namespace whirl::film
