#pragma once
// The bush or the journal of a film with heat, and how it meets the film.

#include <optional>
#include <vector>

#include "whirl/thermal/energy.hpp"
#include "whirl/thermal/options.hpp"
#include "whirl/thermal/solid.hpp"

namespace whirl::thermal {

/// Arrays are [r, n]. A solid meets the film in Robin conditions during the rounds, and as it is in the end.
class ThdWall {
public:
  /// At the ambient's temperature. Keeps `half` [W/K], of the film's half layer, and `temperature` of the film [K, r,
  /// n, l], and follows what they become; `cold` is the film's thickness there [m]. Collective.
  ThdWall(const Rows& rows, const WallOptions& options, bool is_journal, double film_conductivity,
          const std::vector<double>& cold, const std::vector<double>& half, const std::vector<double>& temperature);

  /// After a change of `half`.
  void follow();
  /// Where the film's conductance at a wall changes with the temperature or by turbulence, the solid has the same.
  void set_factor(std::vector<double> factor) { factor_ = std::move(factor); }
  /// What the film has at this wall.
  [[nodiscard]] Wall beside_film() const;
  /// K, of the film's surface: what a cell of the film and one of the solid have between them.
  [[nodiscard]] double surface(std::size_t c) const;
  /// The solid meets the film in Robin conditions, during the rounds, or as it is. Collective.
  void join(bool rounds);
  /// Heat of the film to a solid, and its temperature behind the wall; to `left` of its residual. Returns iterations.
  /// Collective.
  int conduct(double left);
  /// m, what row r of the film loses of its thickness by the growth of the solid.
  [[nodiscard]] double growth(std::size_t r) const { return rise.empty() ? 0 : grows_ * rise[r]; }

  const WallOptions& options;
  std::optional<Solid> solid;
  core::Vector solid_temperature;
  std::vector<double> behind;  // K, what stands behind the film's cell
  // Of a solid: what the film conducts to is not its cell but one beyond it, whose temperature is this, K. It agrees
  // with `behind` in the end.
  std::vector<double> seen;
  std::vector<double> rise;  // K [r], growth over expansion times radius; empty: it does not grow

private:
  [[nodiscard]] double own(std::size_t c) const { return temperature_[c * across_ + layer_]; }
  // W/K between a cell of the film and one of the solid at the temperature that the film has.
  [[nodiscard]] double through(std::size_t c) const {
    return factor_.empty() ? conductance_[c] : 1 / (1 / (half_[c] * factor_[c]) + resistance_[c]);
  }
  [[nodiscard]] bool is_adiabatic() const { return options.type == WallOptions::Type::adiabatic; }

  const std::vector<double>&half_, &temperature_;
  std::size_t across_, layer_;  // cells across the film, and the one at this wall
  core::Vector rhs_;
  std::vector<double> conductance_;  // W/K, between the film's cell and what stands behind
  // Of a solid: K/W from the wall to the solid's cell, W/K through which it meets the film, K/W of `seen`.
  std::vector<double> resistance_, robin_, beyond_;
  std::vector<double> factor_;  // - of the film's half layer; empty: 1
  double grows_ = 0;            // m/K, of the clearance
};

}  // namespace whirl::thermal
