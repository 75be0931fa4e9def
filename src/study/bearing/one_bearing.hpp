#pragma once
// One bearing by itself in nondimensional form: F* = (c/R)^2 F/(mu Omega L D), lengths in clearances.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "study/bearing/journal_locus.hpp"
#include "whirl/film/contract/film.hpp"
#include "whirl/system/train.hpp"

namespace whirl::study {

/// Stiffness c k/(mu Omega L D (R/c)^2) and damping c Omega b/(same), entries xx, xy, yx, yy.
struct BearingCoefficients {
  std::array<double, 4> k, b;
  void members(auto& archive) { archive(k, b); }
};

/// A journal at rest in the bearing, its film carrying a load along -y. NaN: unknown.
struct BearingEquilibrium {
  double eccentricity = 0;     ///< in clearances
  double attitude = 0;         ///< from the load to the journal [rad]
  double sommerfeld = 0;       ///< S = (c/R)^2 load/(mu Omega L D)
  double speed_limit = 0;      ///< Omega sqrt(m c/load) of a rigid rotor at the border of stability; NaN: always stable
  double whirl_ratio = 0;      ///< whirl frequency there over Omega
  std::vector<double> states;  ///< own states of the film, if it has any
  void members(auto& archive) { archive(eccentricity, attitude, sommerfeld, speed_limit, whirl_ratio, states); }
};

/// Pressure and thickness around the bearing in its mid-plane.
struct BearingProfile {
  std::vector<double> theta;      ///< from +x [rad]
  std::vector<double> pressure;   ///< (c/R)^2 p/(6 mu Omega)
  std::vector<double> thickness;  ///< in clearances
  void members(auto& archive) { archive(theta, pressure, thickness); }
};

/// The film of one bearing at a shaft speed. Not collective; not thread-safe.
class OneBearing {
public:
  /// @param speed shaft speed Omega [rad/s]
  OneBearing(const system::Support& support, double speed);
  /// A film on a rigid bore without own states: its force does not depend on what was before.
  [[nodiscard]] bool rigid() const { return film_->states() == 0 && !soft_; }
  /// The journal at this eccentricity, sought from an equilibrium `near` it (attitude and states). Empty where no film
  /// is found, or none that carries a load downwards.
  [[nodiscard]] std::optional<BearingEquilibrium> carrying(double eccentricity, const BearingEquilibrium& near);
  /// The centred journal, to start from.
  [[nodiscard]] BearingEquilibrium centred() const;
  /// Its equilibria, whose nodes follow() of it has not found yet. Only one locus of a bearing is in use.
  [[nodiscard]] JournalLocus locus() { return {*film_, clearance_, speed_, load_}; }
  /// The equilibrium at a node of the locus.
  [[nodiscard]] std::optional<BearingEquilibrium> carrying(const JournalLocus::Node& node);
  /// Of the equilibrium found last, at the frequency ratio omega/Omega; it matters for films with own states only.
  /// Source: van de Vrande (2001) secs. 4.3 and 4.4.
  [[nodiscard]] BearingCoefficients coefficients(double ratio);
  /// Least thickness [m] of the film of the equilibrium found last.
  [[nodiscard]] double thinnest() { return film_->least_thickness(motion_, states_); }
  /// Of the equilibrium found last; empty arrays if the film knows no pressure.
  [[nodiscard]] BearingProfile profile();
  /// W along and across a squeeze velocity in +x with the shaft at rest, F* = -|v_s*| W, of a film without own states;
  /// NaN where it is closed.
  [[nodiscard]] std::array<double, 2> impedance(double along, double across);

private:
  std::array<double, 2> force();
  void set_border(BearingEquilibrium& e);

  double clearance_, speed_;
  bool soft_;
  double load_ = 0;      // N, of F* = 1
  double pressure_ = 0;  // Pa, of p* = 1
  std::unique_ptr<film::Film> film_;
  film::JournalMotion motion_;
  film::StateResponse response_;
  std::vector<double> states_, rest_;
};

}  // namespace whirl::study
