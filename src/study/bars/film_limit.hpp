#pragma once
// Film thicknesses against the least ones that journals and bearings bear.

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "study/bars/error_bar.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// The limits of the places of a plant. Thicknesses are those of Plant::film_thickness().
class FilmLimit {
public:
  explicit FilmLimit(const system::ShownPlaces& places);

  /// False for plants without films.
  [[nodiscard]] bool exists() const { return !limits_.empty(); }
  /// The least of (thickness - limit)/clearance over all places; not positive where two surfaces touch.
  [[nodiscard]] double margin(const std::vector<double>& thickness) const;
  /// "film of bearing B4 falls below 0.09 um (minimum_film)": of the place of the least margin.
  [[nodiscard]] std::string reason(const std::vector<double>& thickness) const;
  /// The same of a motion that ends there, with how it could go on.
  [[nodiscard]] std::string ends(const std::vector<double>& thickness) const;
  /// "; the film of bearing B4 is 0.2 um thick": of the same place, for what ended for another reason. Empty without
  /// films.
  [[nodiscard]] std::string thinnest(const std::vector<double>& thickness) const;
  /// Adds a warning for each place whose film is thinner than its limit; `where` says of what: "at 3600 rpm".
  void warn(const std::vector<double>& thickness, const std::string& where, io::StudySummary& summary) const;

private:
  [[nodiscard]] double margin(double thickness, std::size_t place) const;
  [[nodiscard]] std::size_t worst(const std::vector<double>& thickness) const;
  std::vector<std::string> names_;
  std::vector<double> limits_, clearances_;
};

/// Margin of one more point of a branch, and the slope of the margins over the parameter between the last two points.
class MarginSlope {
public:
  void add(double parameter, double margin);
  /// Not a number before the second point, or if the parameter did not move.
  [[nodiscard]] double value() const { return slope_; }
  /// Between these two points; zero before the second one.
  [[nodiscard]] double step() const { return step_; }
  /// Where the parameter began to run as it does between them.
  [[nodiscard]] double begin() const { return begin_; }

private:
  double slope_ = std::numeric_limits<double>::quiet_NaN(), step_ = 0, parameter_ = 0, margin_ = 0, begin_ = 0;
  bool any_ = false;
};

/// Where the margin vanishes of a branch on another mesh, whose contact on the mesh in use is at `place`: by steps that
/// double until it is enclosed, and then by false positions, to a hundredth of what the places differ by. Close to a
/// wall margins are no straight lines over the parameter and may turn on the way. `margin` gives the margin of the
/// solution at a parameter, found from the solution before, or not a number where there is none; it is asked at `place`
/// first, then on the side that `here`, slope and last step of the branch, came from. Not a number if the margin does
/// not come to zero within eight times the parameter.
[[nodiscard]] double contact_there(double place, const MarginSlope& here, const std::function<double(double)>& margin);

/// Puts the place of contact into the summary, its bar from the places on other meshes, and a warning with these where
/// the bar is unknown or longer than half the place. Thin films of soft liners have no limit on finer meshes: where
/// each refinement moves the place farther than the one before, the bar is unknown for that reason.
void put_contact(io::StudySummary& summary, double place, const std::string& unit, double location, const MeshLaw& law,
                 const std::vector<Sample>& there);

/// One number for each of `places` places: the thickness, or not a number where there is no film.
[[nodiscard]] std::vector<double> film_column(std::vector<double> thickness, std::size_t places);

/// Smallest thickness of each place over a cycle, by the parabola through the least node and its neighbours.
/// Collective on the plant's communicator.
[[nodiscard]] std::vector<double> least_films(const solve::Cycle& cycle, system::Plant& plant);

}  // namespace whirl::study
