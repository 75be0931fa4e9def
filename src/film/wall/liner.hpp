#pragma once
// What carries a film: the pressure of the liner on its deflection, and of asperities where the surfaces touch.

#include <span>
#include <vector>

#include "whirl/film/contract/elastic.hpp"

namespace whirl::film {

/// P of the film at some nodes and its derivatives by the thickness in all, by the deflection alone (which the journal
/// moves at constant thickness) and by the rate of the deflection; and P of the asperities with its slope in h. Zero
/// where nothing is put.
struct Carried {
  std::vector<double> p, by_h, by_u, by_rate, contact, stiff;
  void resize(std::size_t nodes);
  void clear(std::size_t first, std::size_t count);
};

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
  LinerLaw(const Geometry& geometry, const Compliant& options, double b, double pressure);

  [[nodiscard]] bool damped() const { return damping_ > 0.0; }
  [[nodiscard]] bool touches() const { return reach_ > 0.0; }
  /// 1/b, slope dP/du at u = 0.
  [[nodiscard]] double stiffness() const { return stiffness_; }
  /// dP/d(du/dt) = tau/b.
  [[nodiscard]] double damping() const { return damping_; }

  /// What films of thickness h carry on deflections u that change at `rates` (used if damped), to the nodes `first`,
  /// `first` + 1, ... of `out`. Throws core::DomainError where the layer has no thickness left.
  void carry(std::span<const double> h, std::span<const double> u, std::span<const double> rates, std::size_t first,
             Carried& out) const;

  struct Value {
    double pressure = 0.0, slope = 0.0;
  };
  /// phi(u)/b with its slope. Throws as carry() does.
  [[nodiscard]] Value elastic(double u) const;
  /// P_c(h) with its slope, zero from h = 4 sigma on.
  [[nodiscard]] Value contact(double h) const;
  /// A place without film, where the layer is pressed by the asperities alone and follows at once: phi(u)/b =
  /// P_c(`rigid` + u), with the thickness `rigid` over the undeflected layer.
  struct Edge {
    double h = 0.0, by_rigid = 1.0;  // h = rigid + u and dh/d(rigid)
    Value contact{};                 // P_c(h)
  };
  [[nodiscard]] Edge edge(double rigid) const;

private:
  // phi(u)/b of many; false where no thickness is left.
  bool rubber(std::span<const double> u, double* p, double* slope) const;

  double stiffness_, damping_, thickness_ = 0.0;  // D in clearances
  bool rubber_;
  double reach_ = 0.0, scale_ = 0.0;  // 4 sigma in clearances; P_c at h = 0
};

}  // namespace whirl::film
