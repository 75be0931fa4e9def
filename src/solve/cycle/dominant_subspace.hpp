#pragma once
// The invariant subspace of the largest eigenvalues of an operator that is known by its products only, by SLEPc.

#include <petscvec.h>

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <vector>

namespace whirl::solve {

/// Eigenvalues of largest modulus, and an orthonormal basis (this rank's rows [n_local x p]) of the invariant subspace
/// of those above `radius`.
struct DominantSubspace {
  /// Falling modulus: all above the radius, and at least one below; or SubspaceOptions::most of those above.
  std::vector<std::complex<double>> values;
  Eigen::MatrixXd basis;
};

struct SubspaceOptions {
  double radius = 0.3;
  double tolerance = 1e-9;  ///< residual of an eigenpair above the radius, in its eigenvalue
  int most = 1 << 20;       ///< of them, although more may be above the radius
  int spare = 0;            ///< vectors of the search beside those asked for, at least half as many; 0: as many and six
  int restarts = 20;        ///< after which the search is given up
  int guess = 4;            ///< eigenvalues asked for first; more are found until one is below the radius
  /// Where the search is given up it begins again with more vectors, as long as `most` allows it: many values of nearly
  /// one modulus need them.
  bool persistent = false;
};

/// Krylov-Schur (prefix "monodromy_") on v := M v from `start`. The number of vectors follows from the radius.
/// Collective on the communicator of `start`; throws core::NotConverged.
[[nodiscard]] DominantSubspace dominant_subspace(const std::function<void(Vec)>& multiply, Vec start,
                                                 const SubspaceOptions& options);

/// The same for the multipliers of a cycle, above `radius` instead of options.radius. Where the search is given up the
/// radius becomes 0.5 and stays so. Films on soft liners at high speed have a dense band of multipliers, as have stiff
/// films at Gauss points: it takes no part in what the cycle does, and is left below. That search is
/// persistent. Throws core::NotConverged if it is given up too.
[[nodiscard]] DominantSubspace dominant_multipliers(const std::function<void(Vec)>& multiply, Vec start,
                                                    SubspaceOptions options, double& radius);

}  // namespace whirl::solve
