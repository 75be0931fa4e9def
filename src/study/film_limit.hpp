#pragma once
// Film thicknesses against the least ones that journals and bearings bear.

#include <string>
#include <vector>

#include "whirl/io/summary.hpp"
#include "whirl/solve/cycle.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// The limits of the places of a plant. Thicknesses are those of Plant::film_thickness().
class FilmLimit {
public:
  explicit FilmLimit(const system::Places& places);

  /// False for plants without films.
  [[nodiscard]] bool exists() const { return !limits_.empty(); }
  /// The least of (thickness - limit)/clearance over all places; not positive where two surfaces touch.
  [[nodiscard]] double margin(const std::vector<double>& thickness) const;
  /// "film of bearing B4 falls below 0.09 um (minimum_film)": of the place of the least margin.
  [[nodiscard]] std::string reason(const std::vector<double>& thickness) const;
  /// Adds a warning for each place whose film is thinner than its limit; `where` says of what: "at 3600 rpm".
  void warn(const std::vector<double>& thickness, const std::string& where, io::StudySummary& summary) const;

private:
  [[nodiscard]] double margin(double thickness, std::size_t place) const;
  std::vector<std::string> names_;
  std::vector<double> limits_, clearances_;
};

/// One number for each of `places` places: the thickness, or not a number where there is no film.
[[nodiscard]] std::vector<double> film_column(std::vector<double> thickness, std::size_t places);

/// Smallest thickness of each place over a cycle, by the parabola through the least node and its neighbours.
[[nodiscard]] std::vector<double> least_films(const solve::Cycle& cycle, const system::Plant& plant);

}  // namespace whirl::study
