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
  std::vector<std::complex<double>> values;  ///< falling modulus: all above the radius, and at least one below
  Eigen::MatrixXd basis;
};

struct SubspaceOptions {
  double radius = 0.3;
  double tolerance = 1e-9;  ///< residual of an eigenpair above the radius, in its eigenvalue
  int most = 1 << 20;       ///< of them, although more may be above the radius
  int spare = 0;            ///< vectors of the search beside those asked for, at least half as many; 0: as many and six
  int restarts = 200;       ///< after which the search is given up
  int guess = 4;            ///< eigenvalues asked for first; more are found until one is below the radius
};

/// Krylov-Schur (prefix "monodromy_") on v := M v from `start`. The number of vectors follows from the radius.
/// Collective on the communicator of `start`; throws core::NotConverged.
[[nodiscard]] DominantSubspace dominant_subspace(const std::function<void(Vec)>& multiply, Vec start,
                                                 const SubspaceOptions& options);

}  // namespace whirl::solve
