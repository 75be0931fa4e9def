#pragma once
// What studies of branches and motions need of a system beside its equations.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "whirl/problem/system.hpp"
#include "whirl/system/dimensionless_groups.hpp"

namespace whirl::system {

/// Two outputs that are shown against each other, and their rates: a journal in its bearing, in x and y.
struct PlaceState {
  std::array<double, 2> position{}, velocity{};  ///< in ShownPlaces::unit, and the same per second
};

/// The pairs of outputs that results show.
struct ShownPlaces {
  std::vector<std::string> names;
  std::vector<double> clearances;     ///< a length to measure them in, in `unit`; zero where there is none
  std::string unit;                   ///< of positions: "m"
  std::string rate_unit;              ///< of velocities: "m/s"
  std::string text;                   ///< what a position is: "journal relative to the bearing centre"
  std::vector<double> least_films{};  ///< thickness below which the surfaces touch, in `unit`; empty: there are none
};

/// What results show of one state, small and the same on all ranks.
struct Observed {
  std::vector<PlaceState> shown;       ///< as Plant::shown()
  std::vector<double> film_thickness;  ///< as Plant::film_thickness()
};

/// A system that branches of equilibria and cycles and motions can be computed of, whatever it is made of. All members
/// are collective on comm() unless they say not.
class Plant : public problem::System {
public:
  /// Not collective.
  [[nodiscard]] virtual ShownPlaces places() const = 0;
  /// The outputs at a state held as a whole [size()]. Not collective.
  [[nodiscard]] virtual std::vector<PlaceState> shown(const double* x) const = 0;
  /// Smallest film thickness of each place at a whole state, in ShownPlaces::unit: in the mid-plane of its bearing, or
  /// over the whole length where the film tilts; infinite where there is no film, empty if no place has one. Not
  /// collective.
  [[nodiscard]] virtual std::vector<double> film_thickness(const double* /*x*/) const { return {}; }
  /// shown() at a distributed state.
  [[nodiscard]] virtual std::vector<PlaceState> shown_at(Vec x) { return shown(gather(x).data()); }
  /// Both at a distributed state.
  [[nodiscard]] virtual Observed observe(Vec x) {
    const std::vector<double> whole = gather(x);
    return {shown(whole.data()), film_thickness(whole.data())};
  }
  /// A state from which Newton's method finds an equilibrium at the present parameter.
  [[nodiscard]] virtual core::Vector guess() = 0;
  /// Moves x away from an equilibrium by `offset` in both directions, per clearance; own states follow.
  virtual void displace(Vec x, const std::array<double, 2>& offset) = 0;
  /// Switches periodic forcing off (and on again): an equilibrium is that of the system without. On at the start. Not
  /// collective.
  virtual void set_forcing(bool /*on*/) {}
  /// Whether something of its own forces it at the angle of its speed, beside what a study applies. Not collective.
  [[nodiscard]] virtual bool forced() const { return false; }
  /// dF/d(dx/dt) depends on nothing but the parameter. Not collective.
  [[nodiscard]] virtual bool constant_rates() const = 0;
  /// Whether it has meshes of films that may be halved for an estimate of their error. Not collective.
  [[nodiscard]] virtual bool has_film_mesh() const { return false; }
  /// A whole state of `other`, which differs in film meshes only, on the meshes of this system. Not collective.
  [[nodiscard]] virtual std::vector<double> resampled(const Plant& /*other*/, const double* x) const {
    return {x, x + size()};
  }
  /// The same into the distributed state `to`, each rank its rows. Collective; throws as the films do.
  virtual void resample(const Plant& other, const double* x, Vec to) const { core::fill(to, resampled(other, x)); }
  /// Nondimensional groups of a rigid rotor in equal bearings; empty for all else. Not collective.
  [[nodiscard]] virtual std::optional<DimensionlessGroups> groups() const { return {}; }
  /// Whole state on every rank [size()].
  [[nodiscard]] std::vector<double> gather(Vec x) const { return core::gather(x); }
};

}  // namespace whirl::system
