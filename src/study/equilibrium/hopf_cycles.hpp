#pragma once
// The cycles born at a Hopf point, at amplitudes that matter: what its criticality is where forces are smooth by pieces
// only.

#include <array>
#include <optional>
#include <string>

#include "whirl/core/petsc.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// How far a motion of scaled states moves the place that moves most, in clearances; of a plant without clearances the
/// largest scaled state. `system` outlives it.
[[nodiscard]] solve::MotionSize motion_of_places(system::Plant& system);

/// The motion of a Hopf point, scaled states [n], of such a length that the place that moves most describes an ellipse
/// whose larger half-axis is one clearance (of a plant without clearances: the largest scaled state moves by one).
struct CriticalMotion {
  Eigen::VectorXcd q;
  double largest = 1;  ///< its largest scaled state
  std::string place;   ///< which one moves most, empty without clearances
};
/// At the equilibrium x (SI) and the plant's parameter. Collective; throws core::NotConverged.
[[nodiscard]] CriticalMotion critical_motion(system::Plant& system, Vec x, double omega);

/// Curvature c of p = p_0 + c A^2 over the amplitude A in clearances of cycles of amplitudes A/4, A/2, A. p_0 is free:
/// kinks of a force move the Hopf point itself, which sees one place of the mesh only, away from where cycles that
/// reach over several cells would begin.
struct BirthOfCycles {
  double curvature = 0;  ///< by the two larger cycles [scaled parameter]
  double smaller = 0;    ///< by the two smaller ones
  std::array<double, 3> amplitudes{};

  /// What the smaller cycles leave open of the curvature. Where forces are C1: how far it is from c if the branch is
  /// p_0 + c A^2 + d A^4. Where they have kinks themselves there is no parabola near A = 0, and the curvature says what
  /// cycles do that reach over several cells; only if the smaller ones do otherwise, all that lies between is open.
  [[nodiscard]] double doubt(bool kinks) const;
};
/// Cycles by harmonic balance about the equilibrium x (SI), begun at A = `largest` and, where such cycles do not
/// exist (a journal near its wall), at half, a quarter, an eighth of it. Nothing if none of them are found, or the
/// plant is spread over ranks. The plant is left at its parameter. Collective.
[[nodiscard]] std::optional<BirthOfCycles> birth_of_cycles(system::Plant& system, Vec x, double omega,
                                                           double parameter_scale, int harmonics, double largest = 0.2);

}  // namespace whirl::study
