#pragma once
// What carries a film: the pressure of the liner on its deflection, and of asperities where the surfaces touch.

#include "whirl/film/options.hpp"

namespace whirl::film {

/// P of an elastic layer that is deflected by u, in clearances and in the scales of the compliant films (1/s):
///
///     P = (phi(u) + tau du/dt)/b,   phi(u) = u, or of rubber of thickness D: D/3 ((1 - u/D)^-2 - (1 - u/D))
///
/// The damping is that of a Kelvin-Voigt solid. The rubber law has the slope 1 at u = 0, stiffens without bound as u
/// tends to D and is that of bonded blocks in compression, Lindley (1966) after Gent and Lindley (1959), with b in
/// place of their apparent modulus. Under suction, phi(-u) = -phi(u): a liner that gave way more easily there would
/// have its film pressed out by a large whirl, because the equation of the film keeps negative pressures. The film
/// carries P less the contact pressure P_c(h) of the asperities (Contact).
class LinerLaw {
public:
  /// `b` in s, `pressure` = p/P in Pa s.
  LinerLaw(const Geometry& geometry, const Options& options, double b, double pressure);

  [[nodiscard]] bool linear() const { return !rubber_; }
  [[nodiscard]] bool damped() const { return damping_ > 0.0; }
  [[nodiscard]] bool touches() const { return reach_ > 0.0; }
  /// 1/b, slope dP/du of the linear layer.
  [[nodiscard]] double stiffness() const { return stiffness_; }
  /// dP/d(du/dt) = tau/b.
  [[nodiscard]] double damping() const { return damping_; }

  struct Value {
    double pressure, slope;
  };
  /// phi(u)/b with its slope. Throws core::DomainError where the layer has no thickness left.
  [[nodiscard]] Value elastic(double u) const;
  /// P_c(h) with its slope, zero from h = 4 sigma on.
  [[nodiscard]] Value contact(double h) const;

private:
  double stiffness_, damping_, thickness_ = 0.0;  // D in clearances
  bool rubber_;
  double reach_ = 0.0, scale_ = 0.0;  // 4 sigma in clearances; P_c at h = 0
};

}  // namespace whirl::film
