#pragma once
// dF/dp of a parameter other than the speed, from the parts that depend on it.

#include <array>
#include <memory>
#include <vector>

#include "film_part.hpp"
#include "rotor_part.hpp"
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
  void derivative(double angle, Vec x, Vec xdot, Vec f);

private:
  struct Film {
    std::size_t bearing;
    std::unique_ptr<FilmPart> minus, plus;
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
  /// Differences of the films on this rank [bearings]. Throws as they do.
  [[nodiscard]] std::vector<FilmRate> film_rates(const FilmInputs& in);
  /// Takes from them what the moving places do.
  void move(const FilmInputs& in, std::vector<FilmRate>& rates);

  RotorSystem& system_;
  double step_;
  RotorPart::Rates hub_;
  std::vector<Place> places_;
  std::vector<Film> films_;
};

}  // namespace whirl::system
