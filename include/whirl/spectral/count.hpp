#pragma once
// How many eigenvalues a large system has near zero, beside those that a search has found.

#include <vector>

#include "whirl/problem/system.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::spectral {

/// A count of the eigenvalues in the circle |lambda| < radius, beside those that a search has found.
struct EigenCount {
  double radius = 0;  ///< [1/s]; zero: nothing was counted
  int counted = 0;    ///< both of each pair
  int missed = 0;     ///< of these not found
  double real = 0;    ///< near this place above `radius` is a real eigenvalue that was not found [1/s]; zero: none
  bool sure = true;   ///< false: the phase could not be followed, or fewer were counted than found
  int factorisations = 0;
};

/// Counts at the equilibrium x, by the winding number of det(dF/dx + lambda dF/d(dx/dt)) over the product of (lambda -
/// lambda_k) of the eigenvalues found, along the circle. Those found cancel, so that the phase turns only where one is
/// missing, and a few dozen factorisations follow it. The radius lies in the widest gap of the moduli of `found`, which
/// are those nearest to zero, between 0.04 and 0.4 of the largest. The sign of the determinant on the positive real
/// axis beyond tells of an odd number of real eigenvalues there.
///
/// For sparse systems, as shafts are: rows as long as a film fill the factors. Nothing is counted where these have more
/// than 2,000,000 entries, or with fewer than four eigenvalues found. One rank works, all get the result. Collective.
[[nodiscard]] EigenCount count_eigenvalues(problem::System& system, Vec x, const std::vector<Mode>& found);

}  // namespace whirl::spectral
