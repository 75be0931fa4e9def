#pragma once
// Eigenvalues of a machine from the transfer functions of its films.

#include <string>
#include <vector>

#include "whirl/problem/system.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {

/// The region: an ellipse about the real axis that spans [-decay, frequency] along it and +-frequency across.
struct TransferOptions {
  double frequency = 0;   ///< [rad/s], positive
  double decay = 0;       ///< [1/s], positive
  int contour = 256;      ///< points on its upper half for the count and the first search
  int levels = 3;         ///< how often the search begins anew, on circles half as large, while eigenvalues are missing
  double fit = 1e-10;     ///< accuracy of the rational fit through the samples of H, relative
  int most_samples = 80;  ///< of H for one fit
  bool shapes = true;
};

/// The eigenvalues in the region.
struct TransferModes {
  std::vector<spectral::Mode> modes;  ///< as of spectral::modes
  int counted = 0;  ///< how many there are, both of each pair: winding number of det T and the eigenvalues of the films
  int missed = 0;   ///< of these not among the modes
  int poles = 0;    ///< eigenvalues of the films with held journals in the region
  int solves = 0;   ///< evaluations of H
  double fit = 0;   ///< error of the last samples of H against the fit that did not know them, relative
  std::string doubt;  ///< why the count itself is not sure; empty if it is
};

/// All eigenvalues in the region, of T(lambda) z = 0.
///
/// H is sampled along the contour and fitted by a rational function. The fit, which costs nothing to evaluate, gives
/// the winding number of det T and, by moments of T^-1 along the contour (Beyn), the candidates. Each is refined by
/// Newton's method with the true H and its derivative to 1e-12. Eigenvalues of the films with held journals, from
/// SLEPc, are poles of det T and complete the count. `missed` is not zero where an eigenvalue was not found, an
/// eigenvalue is multiple, or one lies on the contour. One rank decides, all share the solves. Collective; throws
/// core::NotConverged. Source: Beyn (2012), Linear Algebra Appl. 436, 3839.
[[nodiscard]] TransferModes transfer_modes(problem::System& system, Vec x, const TransferOptions& options);

}  // namespace whirl::solve
