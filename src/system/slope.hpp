#pragma once
// dF/dp of a parameter other than the speed, from the parts that depend on it.

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "film_part.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

/// With T(p) the train, from T(p-) and T(p+) on both sides of one value of p:
///
///     dF/dp = dM v' + (dC + Omega dG) v + dK q - d(load) - d(unbalance) - B df,   and dg of own states
///
/// F is linear in the entries of pedestals, in gravity, load and amounts of unbalance: what is differenced there are
/// the numbers of T, so that dF/dp is exact to rounding. A bearing that moves (its elevation) moves its journal the
/// other way, through the tangents of its film. All else is a central difference of what depends on p, the matrices of
/// a rotor or the response of a film. What does not depend on p is neither made nor evaluated.
class RotorSystem::Slope {
public:
  /// `step` is p+ - p-. Collective; throws core::InputError where a part refuses its numbers.
  Slope(RotorSystem& system, const Train& minus, const Train& plus, double step);
  /// f = dF/dp. Collective; throws as RotorSystem::residual() does.
  void derivative(double angle, Vec x, Vec xdot, Vec f) const;

private:
  struct Pedestal {
    PetscInt row;
    double mass, damping, stiffness;
  };
  struct Film {
    std::size_t bearing;
    FilmPart minus, plus;
  };
  /// Of a bearing, along the ports of its film.
  struct Place {
    std::size_t bearing;
    std::array<double, 4> rate;
  };
  struct FilmRate {
    std::array<double, 4> force{};
    std::vector<double> residual;  // of the rows here
  };
  void take_matrices(const rotor::Rotor& minus, const rotor::Rotor& plus);
  /// Differences of the films on this rank [bearings]; `evaluate(bearing, part, response)`. Throws as they do.
  template <class Evaluate>
  [[nodiscard]] std::vector<FilmRate> film_rates(const Evaluate& evaluate) const;
  /// Load and unbalance on this rank's coordinate i.
  [[nodiscard]] double force_on(PetscInt i, const std::array<double, 2>& factors) const;

  RotorSystem& system_;
  double step_;
  std::optional<Matrices> matrices_;  // if the rotor itself depends on p
  std::vector<Pedestal> pedestals_;   // on this rank, that do
  std::vector<double> load_;          // empty: it does not
  std::optional<Unbalances> unbalance_;
  std::vector<Place> places_;
  std::vector<Film> films_;
};

}  // namespace whirl::system
